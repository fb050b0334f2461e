"""What holds for all tests here."""

import os

# Its threads yield to each other at every small matrix: beside other work a second becomes minutes.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
