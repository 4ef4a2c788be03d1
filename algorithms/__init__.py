"""The numerical core: maps, spectra, search and verdict. It knows no screen, no server and no plot."""
