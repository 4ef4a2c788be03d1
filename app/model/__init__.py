"""What page, report and replay show, as data: inputs, jobs, the state of a run, settings, sentences."""
