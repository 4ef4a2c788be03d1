"""One setting or two moved over a range: the plan, the points, the journal, tables and figures."""
