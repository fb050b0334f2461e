"""What parameters are given in tests of invalid values, and what some of them may be."""

NAN, INF = float("nan"), float("inf")
DEEP = []
for _ in range(50):
    DEEP = [DEEP]


def is_flag(value):
    return type(value) is bool


def is_number(low, high):
    return lambda value: type(value) in (int, float) and low <= value <= high
