"""Bar codes for the tests: the widths of bars and spaces, from the tables of the standards."""

import itertools

import numpy as np

DIGITS = (  # EAN and UPC, left hand, odd parity
    ["3211", "2221", "2122", "1411", "1132", "1231", "1114", "1312", "1213", "3112"]
)
PARITIES = [
    "LLLLLL", "LLGLGG", "LLGGLG", "LLGGGL", "LGLLGG",
    "LGGLLG", "LGGGLL", "LGLGLG", "LGLGGL", "LGGLGL",
]  # fmt: skip
UPCE_PARITIES = ["GGGLLL", *(row.translate(str.maketrans("LG", "GL")) for row in PARITIES[1:])]
CODE128 = [
    "212222", "222122", "222221", "121223", "121322", "131222", "122213", "122312", "132212",
    "221213", "221312", "231212", "112232", "122132", "122231", "113222", "123122", "123221",
    "223211", "221132", "221231", "213212", "223112", "312131", "311222", "321122", "321221",
    "312212", "322112", "322211", "212123", "212321", "232121", "111323", "131123", "131321",
    "112313", "132113", "132311", "211313", "231113", "231311", "112133", "112331", "132131",
    "113123", "113321", "133121", "313121", "211331", "231131", "213113", "213311", "213131",
    "311123", "311321", "331121", "312113", "312311", "332111", "314111", "221411", "431111",
    "111224", "111422", "121124", "121421", "141122", "141221", "112214", "112412", "122114",
    "122411", "142112", "142211", "241211", "221114", "413111", "241112", "134111", "111242",
    "121142", "121241", "114212", "124112", "124211", "411212", "421112", "421211", "212141",
    "214121", "412121", "111143", "111341", "131141", "114113", "114311", "411113", "411311",
    "113141", "114131", "311141", "411131", "211412", "211214", "211232", "2331112",
]  # fmt: skip
CODE93 = {  # a to d: shifts
    "0": "131112", "1": "111213", "2": "111312", "3": "111411", "4": "121113", "5": "121212",
    "6": "121311", "7": "111114", "8": "131211", "9": "141111", "A": "211113", "B": "211212",
    "C": "211311", "D": "221112", "E": "221211", "F": "231111", "G": "112113", "H": "112212",
    "I": "112311", "J": "122112", "K": "132111", "L": "111123", "M": "111222", "N": "111321",
    "O": "121122", "P": "131121", "Q": "212112", "R": "212211", "S": "211122", "T": "211221",
    "U": "221121", "V": "222111", "W": "112122", "X": "112221", "Y": "122121", "Z": "123111",
    "-": "121131", ".": "311112", " ": "311211", "$": "321111", "/": "112131", "+": "113121",
    "%": "211131", "a": "121221", "b": "312111", "c": "311121", "d": "122211", "*": "111141",
}  # fmt: skip
CODE39 = {  # w: wide
    "0": "nnnwwnwnn", "1": "wnnwnnnnw", "2": "nnwwnnnnw", "3": "wnwwnnnnn", "4": "nnnwwnnnw",
    "5": "wnnwwnnnn", "6": "nnwwwnnnn", "7": "nnnwnnwnw", "8": "wnnwnnwnn", "9": "nnwwnnwnn",
    "A": "wnnnnwnnw", "B": "nnwnnwnnw", "C": "wnwnnwnnn", "D": "nnnnwwnnw", "E": "wnnnwwnnn",
    "F": "nnwnwwnnn", "-": "nwnnnnwnw", ".": "wwnnnnwnn", " ": "nwwnnnwnn", "*": "nwnnwnwnn",
}  # fmt: skip
I25 = ["nnwwn", "wnnnw", "nwnnw", "wwnnn", "nnwnw", "wnwnn", "nwwnn", "nnnww", "wnnwn", "nwnwn"]
CODABAR = {
    "0": "nnnnnww", "1": "nnnnwwn", "2": "nnnwnnw", "3": "wwnnnnn", "4": "nnwnnwn", "5": "wnnnnwn",
    "6": "nwnnnnw", "7": "nwnnwnn", "8": "nwwnnnn", "9": "wnnwnnn", "A": "nnwwnwn", "B": "nwnwnnw",
}  # fmt: skip


def check_digit(digits):
    """The check digit of EAN and UPC: weights 3 and 1 from the right."""
    weights = itertools.cycle((3, 1))
    return str(-sum(int(digit) * weight for digit, weight in zip(reversed(digits), weights)) % 10)


def hand(digits, parities):
    return "".join(
        DIGITS[int(digit)][:: -1 if parity == "G" else 1] for digit, parity in zip(digits, parities)
    )


def ean13(digits):
    """The text and the widths of an EAN-13 of 12 digits."""
    digits += check_digit(digits)
    left = hand(digits[1:7], PARITIES[int(digits[0])])
    return digits, "111" + left + "11111" + hand(digits[7:], "LLLLLL") + "111"


def ean8(digits):
    digits += check_digit(digits)
    return digits, "111" + hand(digits[:4], "LLLL") + "11111" + hand(digits[4:], "LLLL") + "111"


def upca(digits):
    digits, widths = ean13("0" + digits)
    return digits[1:], widths


def upce(digits):
    """The last of the six digits, 0 to 2, says where zeros were left out."""
    last = digits[5]
    check = check_digit("0" + digits[:2] + last + "0000" + digits[2:5])
    return "0" + digits + check, "111" + hand(digits, UPCE_PARITIES[int(check)]) + "111111"


def code128(text):
    """The text in code set B."""
    values = [104, *(ord(letter) - 32 for letter in text)]
    check = (values[0] + sum(place * value for place, value in enumerate(values))) % 103
    return text, "".join(CODE128[value] for value in [*values, check, 106])


def code93(text):
    letters = list(CODE93)
    checked = text
    for most in (20, 15):
        weights = itertools.cycle(range(1, most + 1))
        places = [letters.index(letter) for letter in reversed(checked)]
        checked += letters[sum(place * weight for place, weight in zip(places, weights)) % 47]
    return text, "".join(CODE93[letter] for letter in f"*{checked}*") + "1"


def wide(pattern, width=3):
    return "".join(str(width) if element == "w" else "1" for element in pattern)


def code39(text):
    return text, "1".join(wide(CODE39[letter]) for letter in f"*{text}*")


def i25(digits):
    """The number of digits is even: one gives the bars, the next one the spaces between them."""
    pairs = zip(digits[::2], digits[1::2])
    data = "".join(
        bar + space for a, b in pairs for bar, space in zip(wide(I25[int(a)]), wide(I25[int(b)]))
    )
    return digits, "1111" + data + "311"


def codabar(digits):
    text = f"A{digits}B"
    return text, "1".join(wide(CODABAR[letter]) for letter in text)


def image(widths, module=2, height=60, quiet=12):
    """An image of the bars, (rows, columns) uint8, with white around them; lengths are in px."""
    colors = itertools.cycle((0, 255))
    row = [value for width, value in zip(map(int, widths), colors) for _ in range(width)]
    bars = np.tile(np.repeat(np.array(row, np.uint8), module), (height, 1))
    return np.pad(bars, quiet * module, constant_values=255)
