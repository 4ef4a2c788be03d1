"""What the page can be switched to: the views of the scene, what there is to learn from, and for whom."""

from __future__ import annotations

MAP, HEIGHTS, SWARM = "Map", "Heights", "Swarm space"
LESSON, MUSEUM, LIVE_DEMO = "Lesson", "Museum", "Live demo"
OPERATOR, RESEARCH = "Operator", "Research"
