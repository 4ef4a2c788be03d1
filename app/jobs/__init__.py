"""Threads, worker processes and executors: where a merge is worked out."""
