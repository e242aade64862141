"""``python -m magsplice``: the program `magsplice`."""

import sys

from _magsplice_program import main

sys.exit(main())
