#!/usr/bin/python3
"""Makes report.md, report.html and figures from results folders of raymeter."""

import sys

sys.dont_write_bytecode = True

from raymeter_report.cli import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
