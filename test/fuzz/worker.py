"""Takes inputs for one target from standard input, and answers what became of each.

An input is its length, 4 bytes, and so many bytes; an answer is a line: "taken", "refused: ..." or
"failed: ..." with a traceback.
"""

import os
import resource
import struct
import sys
import traceback

import targets

LIMIT = 1500 << 20  # bytes that one input may need: twice what the largest image does


def main() -> int:
    target = targets.TARGETS[sys.argv[1]]()
    answers = os.fdopen(os.dup(1), "w")  # what libraries print is no answer
    os.dup2(2, 1)
    target.run(target.seeds()[0])  # what is loaded once is no input's
    with open("/proc/self/statm") as file:
        present = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (present + LIMIT,) * 2)
    print("ready", file=answers, flush=True)
    while True:
        head = sys.stdin.buffer.read(4)
        if len(head) < 4:
            return 0
        data = sys.stdin.buffer.read(struct.unpack("<I", head)[0])
        print(answer_of(target, data), file=answers, flush=True)


def answer_of(target: "targets.Target", data: bytes) -> str:
    try:
        target.run(data)
    except targets.REFUSALS as error:
        text = str(error)
        return f"refused: {text!a}" if is_line(text) else f"failed: no line of text: {text!a}"
    except BaseException:
        return "failed: " + ascii(traceback.format_exc())
    return "taken"


def is_line(text: str) -> bool:
    """Whether an error can stand in a log: short, and one line that tells a terminal nothing."""
    return 0 < len(text) <= targets.LONGEST_ERROR and text.isprintable()


if __name__ == "__main__":
    sys.exit(main())
