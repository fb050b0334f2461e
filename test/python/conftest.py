"""What holds for all tests here."""

import os

# Its threads yield to each other at every small matrix: beside other work a second becomes minutes.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# As many files are tested at a time as there are cores, and threads that wait for work turn in a
# loop. What several threads do is the gtests' matter.
os.environ.setdefault("OPENCV_FOR_THREADS_NUM", "1")
