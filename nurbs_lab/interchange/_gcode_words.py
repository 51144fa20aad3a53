"""The words of a program: each line becomes letters with numbers, or with expressions of parameters.

One grammar for all dialects. What a dialect writes with more letters becomes a small letter of its own, see
`KEYWORDS` and `HEIDENHAIN`. Expressions are those of RS274/NGC, with angles in degrees.
"""

import math
import operator
import re
from functools import lru_cache, partial, reduce

from nurbs_lab.interchange._gcode_holes import hole_of_heidenhain, hole_of_siemens
from nurbs_lab.interchange._gcode_table import NUMBER

LETTERS = re.compile("([A-Za-z@^&])")
CHECKSUM = re.compile(r"^(N\d+[^*=;(\n]*)\*(\d+)(?=[ \t]*(?:;|$))", re.MULTILINE)
COMMENT = re.compile(r"\([^()\n]*\)|;[^\n]*|^[ \t]*<[^<>\n]*>[ \t]*$", re.MULTILINE)
#: What Siemens and Fanuc write with more letters -> the word, or the letter of the value that follows.
KEYWORDS = {"BSPLINE": "b0", "SD=": "d", "PL=": "l", "PW=": "w", "CR=": "R", "SUPA": "G153"}
#: Words that steer how a path is followed, and move nothing.
KEYWORDS |= dict.fromkeys(("MSG", "WORKPIECE", "CYCLE832", "SOFT", "BRISK", "FFWON", "FFWOF", "STOPRE"), "")
KEYWORDS |= dict.fromkeys(("CFC", "CFIN", "CFTCP", "COMPON", "COMPCURV", "COMPCAD", "COMPOF", "TRAFOOF"), "")
KEYWORDS |= dict.fromkeys(("ORIWKS", "DIAMOF", "RTLION", "RTLIOF", "UPATH", "FIFOCTRL", "STARTFIFO"), "")
KEYWORDS |= dict.fromkeys((f"DYN{kind}" for kind in ("NORM", "POS", "ROUGH", "SEMIFIN", "FINISH")), "")
#: Powers of Heidenhain's SPL -> letter.
POWERS = dict(zip((f"K{k}{axis}" for axis in "XYZ" for k in (3, 2, 1)), "cefghijkn", strict=True))
#: What Heidenhain writes instead of G words.
HEIDENHAIN = {"L": "G1", "CC": "p0", "C": "a0", "CR": "a1", "CP": "a2", "IPA": "&", "PA": "^", "SPL": "s0"}
HEIDENHAIN |= {"DR+": "G3", "DR-": "G2", "R0": "", "RL": "G41", "RR": "G42", "CYCL CALL": "M99"} | POWERS
HEIDENHAIN |= {"FMAX": "m0", "F MAX": "m0"}
HEIDENHAIN |= {f"I{axis}": axis.lower() for axis in "XYZ"}  # steps, in G90 too
HEIDENHAIN |= {"LA": "N", "MB": "N", "MAX": "0", "M136": "G95", "M137": "G94"}  # of M120 and M140; feeds
#: Its lines that move nothing.
LEFT_OUT = r"BEGIN PGM|BLK FORM|CYCL DEF 32|TOOL DEF|LBL|STOP\b|\*|PLANE RESET|FUNCTION RESET TCPM"
LEFT_OUT = rf"^[ \t]*(?:{LEFT_OUT})[^\n]*"  # a label that is called is refused there
#: Its shifts, mirrors and turns (7, 8, 10 and 19) back to nothing.
UNDONE = (
    r"^[ \t]*CYCL DEF (7|8|1[09])\.0[^\n]*"
    r"(?:\n[ \t]*CYCL DEF \1\.[1-9](?:[ \t]+(?:ROT|I?[XYZABC])[-+]?[0.]+)*[ \t\v]*$)+"
)
#: Steps and absolute words of Siemens, in G90 and G91 -> letter.
WAYS = {way: dict(zip("XYZIJK", to, strict=True)) for way, to in (("IC", "xyzIJK"), ("AC", "tuvoqr"))}
#: A letter that stands for more of them -> what is written.
SPELT = KEYWORDS | HEIDENHAIN | {f"{word}=AC": letter for word, letter in WAYS["AC"].items()}
SPELT = {letter: word for word, letter in SPELT.items() if letter == "&" or letter.islower()}
#: Values of a cycle of Siemens, some of which may be empty, and a line of one of Heidenhain.
LIST = rf"(?:(?:[ \t]*{NUMBER})?[ \t]*(?:,|(?=\))))*"
WORD = rf"[ \t]*Q\d+[ \t]*=[ \t]*{NUMBER}[ \t]*(?:;[^~\n]*)?"
#: What every such spelling of Siemens, Heidenhain, printers and Fanuc holds, and it -> that of all others.
REWRITTEN = {
    ("C(", r"([XYZIJK])=([IA]C)\(([^()\n]*)\)"): lambda found: f" {WAYS[found[2]][found[1]]}[{found[3]}]",
    ('"', r'T\d*="[^"\n]*"|MSG[ \t]*(?:"[^"\n]*"|\([ \t]*"[^"\n]*"[ \t]*\))'): "",
    ("ADIS", r"\bADIS(?:POS)?[ \t]*=[ \t]*[\d.]+"): "",  # how far G641 rounds a corner
    ("TURN=", r"TURN=([\d.]+)"): r" P[1+\1]",  # full turns before the arc
    ("M11", r"^[ \t]*(?:N\d+[ \t]*)?M11[78]\b[^\n]*"): "",
    ("THEN", r"IF[ \t]*(\[[^\n]*\])[ \t]*THEN[ \t]*#(\d+)[ \t]*=([^\n(;]*)"): r"#[\1*\2+[1-\1]*4999]=\3",
    ("WHILE", r"WHILE[ \t]*(\[[^\n]*\])[ \t]*DO[ \t]*(\d)"): r"O<DO\2> WHILE \1",
    ("END", r"END[ \t]*(\d)"): r"O<DO\1> ENDWHILE",
    ("GOTO", r"(?:IF[ \t]*(\[[^\n]*\])[ \t]*GOTO|GOTO)[ \t]*(\d+)"): lambda found: (
        f"O<{found[2]}> GOTO {found[1] or '[1]'}"
    ),
    ("CYCLE8", rf"(MCALL[ \t]+CYCLE|CYCLE)(8[1-9])[ \t]*\(({LIST})\)"): hole_of_siemens,
    ("MCALL", r"MCALL[ \t]*$"): "G-80 R0Z0I0L0",
    ("=", r"\bR(\d+)[ \t]*="): r" #<_R\1>=",
    ("R", r"(?<=[-=+*/(\[])[ \t]*R(\d+)"): r" #<_R\1>",
    ("$H", r"^[ \t]*\$H[ \t]*$"): "G28",
    ("CYCLE800", r"CYCLE800[ \t]*\([ \t]*\)"): "",
    ("CYCL DEF 2", rf"CYCL DEF (2\d\d)\b[^~\n]*~\n((?:{WORD}~\n)*{WORD}$)"): hole_of_heidenhain,
}
SHIFTED = "shifts, turns, scales or mirrors what follows"
#: What may stand where a word is due -> why it is refused.
NO_WORDS = {
    r"\b(?:A?TRANS|A?ROT|A?SCALE|A?MIRROR|PLANE)\b|CYCL DEF (?:[78]|1[019]|26)\.": SHIFTED,
    r"\b(?:M?CALL|REPEAT|IF|WHILE|FOR|GOTO\w*|LBL|CYCL|PROC|DEF|FN ?\d+)\b": "is a subroutine or a condition",
    r",\s*[ACR]": "rounds or cuts off a corner, or turns by an angle",
    r"^(?:N\d+\s*)?[A-Z_]\w+:": "is a label, to which others jump",
    r"\b(?:[CL]T?P|[CL]T|LN|RND|CHF|APPR|DEP)\b|=AC\b": "holds a command that this reader does not know",
    r"\b(?:[A-Z]{2,}\d*|[SM]\d)=": "holds a word of Siemens that this reader does not know",
    r"\b(?:CIP|POLY|[A-C]SPLINE)\b": "moves along a curve that this reader does not know",
    r"^\$": "is a command to the console of GRBL, not of a program",
    r"\bF(?:[UZ][\d.]|T)": "gives its feed by the turn, the tooth or the time",
    r"\b[QR]\d+\s*=|=\s*[QR]\d|[A-Z][-+]?Q\d|#<_[QR]\d": "holds parameters that this reader does not know",
    r"^(?:N\d+\s*)?[A-Z_]{2,}\w*[ \t]*(?:[\v(\"]|[A-Z]{2,}|$)": "calls what this reader does not know",
    r"[()]": "holds a bracket within a comment, or one that is not closed; mend it",
}
#: What shows a printer: an E word beside a move, a heater, and G28 or G29 with a letter that has no number.
PRINTER = re.compile(
    r"^(?:N\d+[ \t]*)?(?:G(?:0*[0-3]|92)(?![\d.])[^\n]*(?<![A-Z])E[-+.\d]|M1(?:04|09|40|90)[ \t]*S\d"
    r"|G2[89][ \t]+[A-Z](?=[ \t\v]*(?:$|[A-Z])))",
    re.MULTILINE,
)
#: Macros of a printer, and its M words, which take all that follows in their block; those of its own files.
MACRO = re.compile(r"([A-Z]+_\w*)(?!\S)")
ORDER = re.compile(
    r"(?:N\d+\s*)?(M(?:48(?=\s*[PXYV])|73(?=\s*[PQRSD]\d)|(?:17|18|74)(?=\s*[XYZE])|84|92|"
    rf"(?!198|1\d\d(?:\s*[PQ]{NUMBER})*\s*$)[1-9]\d\d+(?:\.\d)?))"
    r'\s*[A-Z](?:"[^"]*"|[^"G])*$'
)
PRINTED = re.compile(
    r"(?:N\d+\s*)?([A-Z]{2,}\w*|M(?!(?:0*2|30|9[89])(?![\d.])|198)[\d.]+|G(?!0*[0-3](?![\d.]))\d+(?:\.\d)?)"
    r'((?:"[^"]*"|[^"G]|G(?![\d.]+(?!\w)))*)$'  # but another G word
)
#: What shows a lathe: a tool with its offset, or a speed of the spindle before steps U and W; and a mill.
LATHE = re.compile(r"(?<![A-Z])T\d{4}(?!\d)|G0*9[67](?!\d)(?s:.*)[\n \d][UW][-+.\d]")
MILL = re.compile(r"M0*6(?!\d)|G0*7(?![\d.])")
#: A number glued to a signed exponent, as languages write it, but G1E-1 and F1800E-1 of printers.
EXPONENT = re.compile(rf"(?<=[A-CI-KP-RU-Z=]){NUMBER}E[-+]\d+(?![\d.])")
FIRST_OF_MACHINE = 5000  # of the numbered parameters; and the names that LinuxCNC lets no program set
NAME_OF_MACHINE = re.compile(
    "_(?:(?:ABS_)?[A-CU-Z]|(?:CURRENT|SELECTED)_(?:TOOL|POCKET)|(?:FEED|SPEED)_OVERRIDE|FEED(?:_HOLD)?|RPM"
    "|(?:MOTION|LATHE_DIAMETER|LATHE_RADIUS|IJK_ABSOLUTE|SPINDLE_RPM|SPINDLE_CSS)_MODE|SPINDLE_(?:ON|CW)"
    "|LINE|PLANE|ADAPTIVE_FEED|COORD_SYSTEM|METRIC|IMPERIAL|ABSOLUTE|INCREMENTAL|INVERSE_TIME|TOOL_OFFSET"
    "|UNITS_PER_(?:MINUTE|REV)|MIST|FLOOD|CCOMP|VALUE(?:_RETURNED)?|VMAJOR|VMINOR|TASK|(?:CALL|REMAP)_LEVEL)"
)
R_PARAMETER = re.compile(r"_[QR]\d+$")  # of Heidenhain and Siemens
MOST_SCANNED = 4096  # lines with expressions that are kept, because loops repeat them
SAME = 1e-4  # numbers that differ by less are equal, as in LinuxCNC
#: Operator -> its level of precedence and what it does.
BINARY = {
    "**": (4, operator.pow),
    "*": (3, operator.mul),
    "/": (3, operator.truediv),
    "MOD": (3, lambda a, b: a % abs(b)),
    "+": (2, operator.add),
    "-": (2, operator.sub),
    "EQ": (1, lambda a, b: abs(a - b) < SAME),
    "NE": (1, lambda a, b: abs(a - b) >= SAME),
    **{name: (1, getattr(operator, name.lower())) for name in ("GT", "GE", "LT", "LE")},
    "AND": (0, lambda a, b: a != 0 != b),
    "OR": (0, lambda a, b: a != 0 or b != 0),
    "XOR": (0, lambda a, b: (a != 0) != (b != 0)),
}
UNARY = {"ABS": abs, "EXP": math.exp, "FIX": math.floor, "FUP": math.ceil, "LN": math.log, "SQRT": math.sqrt}
UNARY["ROUND"] = lambda x: math.copysign(math.floor(abs(x) + 0.5), x)
#: What Fanuc does otherwise with negative numbers.
FANUC = {"FIX": math.trunc, "FUP": lambda x: math.copysign(math.ceil(abs(x)), x), "MOD": math.fmod}
UNARY |= {f.__name__.upper(): lambda x, f=f: f(math.radians(x)) for f in (math.cos, math.sin, math.tan)}
UNARY |= {f.__name__.upper(): lambda x, f=f: math.degrees(f(x)) for f in (math.acos, math.asin)}
OPERATOR = re.compile(r"\s*(\*\*|[-+*/]|MOD|EQ|NE|GT|GE|LT|LE|AND|OR|XOR)")
FUNCTION = re.compile(rf"\s*(ATAN|EXISTS|{'|'.join(UNARY)})\s*\[")
INNER = re.compile(r"(?<=[\d.])[ \t]+(?=[\d.])")
FIGURE, LETTER, NAME = map(re.compile, (rf"\s*({NUMBER})", r"\s*([A-Za-z@^&])", r"<([^<>]*)>"))
SIGN, HASH, EQUALS, SPACE = map(re.compile, (r"\s*([-+])", r"\s*(#)", r"\s*(=)", r"\s*"))


def lines_of(data):
    """The lines of a program in capitals, without comments; and of Heidenhain the unit, or "" without it."""
    text = data.removeprefix(b"\xef\xbb\xbf").decode("latin-1").replace("\r\n", "\n").replace("\r", "\n")
    text = (CHECKSUM.sub(_checked, text) if "*" in text else text).upper()
    if re.match(r"%\S*[ \t]+G7[01]\b", text):
        raise ValueError("line 1: it is G-code of Heidenhain; give the program in its plain language")
    head = re.search(r"BEGIN PGM[^\n]*?\b(MM|INCH)?[ \t]*$", text, re.MULTILINE)
    if head:
        text = re.sub(r"(?<=\d),(?=\d)", ".", text)
        text = EXPONENT.sub(lambda found: f"{float(found[0]):.15f}", text)
    for (mark, pattern), meaning in REWRITTEN.items():
        if mark in text:
            text = re.sub(pattern, meaning, text, flags=re.MULTILINE)
    text = COMMENT.sub("\v", _without_numbers(text) if head else text)  # INNER joins nothing across it
    if head:
        text = re.sub(r"FN 0:[ \t]*Q(\d+)[ \t]*=", r"#<_Q\1>=", text)
        text = re.sub(r"\b([XYZF][-+]?)Q(\d\d?)\b", r"\1#<_Q\2>", text)
        text = re.sub(LEFT_OUT, "", text, flags=re.MULTILINE)
        text = re.sub(UNDONE, lambda found: "\n" * found[0].count("\n"), text, flags=re.MULTILINE)
        text = re.sub(r"\bF ?AUTO\b", "F#<F_OF_TOOL_CALL>", text)
        text = re.sub(r"^[ \t]*TOOL CALL([^\n]*)", _tool_call, text, flags=re.MULTILINE)
        text = re.sub(r"\bM0?(?:30|2)\b", "", text)  # END PGM alone shows that the file is whole
        text = re.sub(r"^[ \t]*END PGM[^\n]*", "M30", text, flags=re.MULTILINE)
    elif found := EXPONENT.search(text):
        said = f"{found[0]} has an exponent, which controllers do not read; write its digits, or a blank"
        raise ValueError(f"line {text.count(chr(10), 0, found.start()) + 1}: {said} before E")
    keywords = HEIDENHAIN if head else KEYWORDS
    if used := [word for word in keywords if word in text]:
        longest = "|".join(  # no value may follow what stands for none
            re.escape(word) + ("" if len(keywords[word]) == 1 else "(?![A-Z0-9.]|[-+]\\d)")
            for word in sorted(used, key=len, reverse=True)
        )
        text = re.sub(rf"\b(?:{longest})", lambda found: f" {keywords[found[0]]}", text)
    return [line.strip() for line in text.split("\n")], head and (head[1] or "")


def _checked(found):
    """A line of a printer without its checksum, all bytes before it joined by XOR."""
    if (right := reduce(operator.xor, found[1].encode("latin-1"))) != int(found[2]):
        line = found.string.count("\n", 0, found.start()) + 1
        raise ValueError(f"line {line}: its checksum is {found[2]}, that of its words {right}; it is damaged")
    return found[1]


def _tool_call(found):
    """The plane of the axis of a tool, the speed, 0 if it is no number, and the feed, which F AUTO means."""
    text = re.sub(r'"[^"]*"', "", found[1])
    planes = [f"G{17 + 'ZYX'.index(axis)}" for axis in re.findall(r"\b[XYZ]\b", text)]
    speeds = [f"S{speed or 0}" for speed in re.findall(rf"\bS *({NUMBER}(?= |$))?", text)]
    feeds = [f"F{feed} #<F_OF_TOOL_CALL>={feed}" for feed in re.findall(r"\bF *(\S+)", text)]
    return " ".join([*planes, *speeds, *feeds])


def _without_numbers(text):
    """Blocks of Heidenhain without their numbers, which are evenly spaced; one that ends in ~ goes on."""
    lines, step, last, place = text.split("\n"), None, None, 0
    for i, line in enumerate(lines):
        if i and lines[place].endswith("~"):
            lines[place], lines[i] = f"{lines[place][:-1]} {line.strip()}", ""
            continue
        place, (number, rest) = i, re.match(r"\s*(\d*)(.*?)\s*$", line).groups()
        lines[i] = rest
        if number and last is not None:
            step = step or int(number) - last
            if not step or int(number) - last != step or not rest:
                said = f"line {i + 1}: its block is empty, or one before it is missing or doubled"
                raise ValueError(f"{said}; mend it, or number anew")
        last = int(number) if number else last
    return "\n".join(lines)


def words_of(line, parameters, spaced=True):
    """The words of a line as ``[(letter, number), ...]``, which may set parameters; blanks in its numbers."""
    parts = LETTERS.split(line)
    if not parts[0] and "_" not in line:  # which Python takes between digits
        try:
            return list(zip(parts[1::2], map(float, parts[2::2]), strict=True))
        except ValueError:
            pass
    words, settings = [], {}
    for letter, key, value in _scanned(line, spaced):
        if letter:
            words.append((letter, value(parameters)))
        else:
            settings[name := _own(key(parameters))] = value(parameters)
            if R_PARAMETER.match(str(name)):  # whether its block sees it is nowhere said
                parameters.pop(name, None)
    parameters.update(settings)
    return words


@lru_cache(MOST_SCANNED)
def _scanned(line, spaced):
    """The words of a line as (letter, None, value), and its settings as (None, what names them, value)."""
    scanner, words = Scanner(INNER.sub("", line) if spaced else line), []
    while not scanner.at_end():
        if scanner.take(HASH):
            key = scanner.parameter()
            scanner.expect("=")
            words.append((None, key, scanner.expression(0)))
        else:
            letter = scanner.take(LETTER) or scanner.expect("a word")
            words.append((letter, None, scanner.expression(0) if scanner.take(EQUALS) else scanner.value()))
    return words


@lru_cache(MOST_SCANNED)
def arguments_of(text):
    """Expressions that follow one another, each in brackets, as functions of the parameters."""
    scanner, values = Scanner(text), []
    while not scanner.at_end():
        scanner.expect("[")
        values.append(scanner.expression(0))
        scanner.expect("]")
    return values


class Scanner:
    """A line that is read from left to right; its expressions become functions of the parameters."""

    def __init__(self, line):
        self.line, self.at = line, 0

    def at_end(self):
        return SPACE.match(self.line, self.at).end() == len(self.line)

    def take(self, pattern):
        if found := pattern.match(self.line, self.at):
            self.at = found.end()
        return found and found[1]

    def expect(self, text):
        at = SPACE.match(self.line, self.at).end()
        if not self.line.startswith(text, at):
            known = [
                why if ";" in why else f"{why}; write its moves out"
                for what, why in NO_WORDS.items()
                if re.search(what, self.line)
            ]
            why = (*known, "is no row of words, each a letter and a number; correct or remove it")[0]
            raise ValueError(f"{shown(self.line)} {why}")
        self.at = at + len(text)

    def value(self):
        """A number, a parameter, a function or an expression in brackets, each maybe with a sign."""
        if text := self.take(FIGURE):
            number = float(text)
            return lambda _: number
        if sign := self.take(SIGN):
            value = self.value()
            return (lambda p: -value(p)) if sign == "-" else value
        if self.take(HASH):
            key = self.parameter()
            return lambda p: p[key(p)]
        if (name := self.take(FUNCTION)) == "EXISTS":
            self.expect("#")
            key = self.parameter()
            self.expect("]")
            return lambda p: float(key(p) in p)
        self.expect("[") if name is None else None
        inner = self.expression(0)
        self.expect("]")
        if name == "ATAN":
            self.expect("/")
            over = self.value()
            return lambda p: math.degrees(math.atan2(inner(p), over(p)))
        return (lambda p: _applied(p.fanuc.get(name, UNARY[name]), inner(p))) if name else inner

    def parameter(self):
        """What names a parameter after its #: a name, or the value of a number."""
        if (name := self.take(NAME)) is not None:
            name = re.sub(r"\s", "", name)
            return lambda _: name
        value = self.value()
        return lambda p: _numbered(value(p))

    def expression(self, level):
        """Operators of this level of precedence or higher, from left to right."""
        left = self.value()
        while (found := OPERATOR.match(self.line, self.at)) and BINARY[found[1]][0] >= level:
            self.at = found.end()
            left = partial(_both, found[1], left, self.expression(BINARY[found[1]][0] + 1))
        return left


def _both(name, left, right, parameters):
    return _applied(parameters.fanuc.get(name, BINARY[name][1]), left(parameters), right(parameters))


def _numbered(number):
    if number != int(number) or number < 1:
        why = "whose numbers are 1, 2, ...; mend it" if number else "but empty in Fanuc; write what it means"
        raise ValueError(f"#{number:g} is no parameter, {why}")
    return number


def _applied(operation, *values):
    try:
        number = operation(*values)
    except (ArithmeticError, ValueError) as error:
        raise ValueError(f"an expression has no value: {error}") from None
    if isinstance(number, complex) or not math.isfinite(number):
        raise ValueError(f"an expression has the value {number}; mend it")
    return float(number)


class Parameters(dict):
    """Numbered and named parameters; a number that was never set gives 0, and a name is refused.

    Of programs of Fanuc, whose functions ``fanuc`` holds, such a number is refused too.
    """

    def __missing__(self, key):
        if isinstance(_own(key), str):
            if R_PARAMETER.match(key):
                raise ValueError(f"{key[1:]} has no value of a block before this one; give it one there")
            raise ValueError(f"#<{key.lower()}> is not set in this file; give it a value first")
        if self.fanuc:
            raise ValueError(f"#{key:g} is not set in this file, and empty in Fanuc; give it a value first")
        return 0.0


def _own(key):
    """A parameter that belongs to the program, and not to the machine."""
    if NAME_OF_MACHINE.fullmatch(key) if isinstance(key, str) else key >= FIRST_OF_MACHINE:
        name = f"<{key.lower()}>" if isinstance(key, str) else f"{key:g}"
        raise ValueError(f"#{name} is a state of the machine, which the file does not hold; write its value")
    return key


def shown(line):
    text = line.strip()
    return repr(text if len(text) <= 40 else text[:40] + "...")
