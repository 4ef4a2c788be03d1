"""What the page can be switched to: the views of the scene, and what there is to learn from."""

from __future__ import annotations

MAP, HEIGHTS, SWARM = "Map", "Heights", "Swarm space"
LESSON, MUSEUM = "Lesson", "Museum"
