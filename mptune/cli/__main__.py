"""``python -m mptune.cli``: the command line."""

from mptune.cli.main import main

main()
