"""What the command lines of the commands have in common."""

import argparse
import re
from typing import Any, Callable, Sequence, Tuple


def command_parser(program: str, description: str, examples: str) -> argparse.ArgumentParser:
    """Returns a parser whose help ends with examples in their own layout."""
    return argparse.ArgumentParser(
        prog=program,
        description=description,
        epilog=examples,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def parse_completely(
    parser: argparse.ArgumentParser,
    command: Sequence[str],
    complete: Callable[[argparse.Namespace], Any],
) -> argparse.Namespace:
    """Parses a command line, and exits if it is wrong.

    Args:
        parser: The parser.
        command: The words of the command line.
        complete: A function that checks what argparse cannot check, and may add to the arguments.
            It raises ValueError for a usage error.
    """
    arguments = parser.parse_args(command)
    try:
        complete(arguments)
    except ValueError as error:
        parser.error(str(error))
    return arguments


def number_within(
    kind: Callable[[str], float], low: float, high: float, above_low: bool = False, unit: str = ""
) -> Callable[[str], float]:
    """Returns a function with which argparse reads an int or a float within a range.

    `above_low` leaves out the lowest number; `unit` is that of all of them, for the error.
    """
    span = f"above {low:g} and at most {high:g}" if above_low else f"from {low:g} to {high:g}"

    def checked(text: str) -> float:
        value = kind(text)
        if not low <= value <= high or (above_low and value == low):
            raise argparse.ArgumentTypeError(f"{text} must be {span} {unit}".rstrip())
        return value

    checked.__name__ = "integer" if kind is int else "number"  # for argparse's error messages
    return checked


def board_size(text: str) -> Tuple[int, int]:
    """Converts WxH of a calibration board to two numbers, for argparse."""
    match = re.fullmatch("([0-9]{1,2})x([0-9]{1,2})", text)
    if not match or min(map(int, match.groups())) < 3:
        raise argparse.ArgumentTypeError(f"'{text}' must be as 8x6, 3 to 99 each")
    return int(match[1]), int(match[2])
