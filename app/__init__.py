"""The page and the command line of mapmeld; everything that draws, prints or listens lives here."""
