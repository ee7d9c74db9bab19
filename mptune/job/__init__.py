"""One study, from file to results: who runs what, and what is written where."""
