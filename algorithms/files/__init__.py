"""Every file that is read or written: maps, observations, truth, case folders."""
