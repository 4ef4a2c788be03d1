"""The files of a result, and the report as HTML."""
