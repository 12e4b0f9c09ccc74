"""`python -m seacrane.cli`."""

import sys

from . import main

sys.exit(main())
