"""IGES 5.3, for programs that cannot read STEP."""

import itertools
import re

from nurbs_lab.interchange._opencascade import nurbs_in, shapes_of, without_greetings

from OCP.IGESControl import IGESControl_Writer  # isort: skip  (after the check that it is there)
from OCP.IGESData import IGESData_IGESWriter
from OCP.IGESSelect import IGESSelect_WorkLibrary
from OCP.TCollection import TCollection_HAsciiString

NO_DATE = "19700101.000000"
CURVES = {100, 102, 104, 110, 112, 126}  # entity types of IGES 5.3
FACES = {114, 118, 120, 122, 128, 140, 143, 144}
#: The length of a text, or a number or nothing and what ends it.
FIELD = re.compile(r" *(?:(\d+)H|(?:[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?)? *([,;]))")


@without_greetings()
def write(path, parts):
    writer = IGESControl_Writer("MM", 1 if parts.solids else 0)  # 1: solids with their topology, entity 186
    for shape in shapes_of(parts):
        writer.AddShape(shape)
    writer.ComputeModel()
    header = writer.Model().GlobalSection()  # without the date, the same shapes make the same file on any day
    header.SetDate(TCollection_HAsciiString(NO_DATE))
    header.SetLastChangeDate(TCollection_HAsciiString(NO_DATE))
    writer.Model().SetGlobalSection(header)
    lines = IGESData_IGESWriter(writer.Model())
    lines.FloatWriter().SetFormat("%.15E")  # the usual nine digits would lose a nanometre on a metre
    lines.FloatWriter().SetZeroSuppress(False)
    lines.SendModel(IGESSelect_WorkLibrary.DefineProtocol_s())
    with path.open("wb") as file:
        lines.Print(file)


def read(path):
    return nurbs_in(path, "IGES", _promised(path))


def _promised(path):
    """The numbers of curves and faces that the directory names.

    The lines of each section are numbered, and the last line of the file says how many there are.
    """
    *lines, last = path.read_text(encoding="latin-1").splitlines() or [""]
    told = {letter: int(count) for letter, count in re.findall(r"([A-Z]) *(\d+)", last[:32])}
    numbered = (f"{letter}{i}" for letter, count in told.items() for i in range(1, count + 1))
    found = (line[72:73] + line[73:80].strip().lstrip("0") for line in lines)
    if last[72:73] != "T" or sum(told.values()) != len(lines) or list(found) != list(numbered):
        raise ValueError("it is no IGES file, or parts of it are missing")
    sections = {letter: [line for line in lines if line[72:73] == letter] for letter in "GDP"}
    _require_fields("".join(line[:72] for line in sections["G"]))
    for _, record in itertools.groupby(sections["P"], lambda line: line[64:72]):
        _require_fields("".join(line[:64] for line in record))
    entries = sections["D"][::2]
    for line in (*entries, *(line[:40] for line in sections["D"][1::2])):
        if not re.fullmatch(r"[-\d ]{40,72}", line[:72]):
            raise ValueError(f"its entry {line.strip()!r} is damaged")
    kinds = [int(line[:8]) for line in entries if line[66:68] in ("00", "  ")]  # those that stand alone
    return sum(kind in CURVES for kind in kinds), sum(kind in FACES for kind in kinds)


def _require_fields(record):
    """Refuse what is neither a number, nor a text that begins with its length; a comment may follow."""
    at, end = 0, ","
    while end != ";":
        found = FIELD.match(record, at)
        if not found:
            raise ValueError(f"its field {record[at : at + 20].strip()!r} is damaged")
        at, end = found.end() + int(found[1] or 0), found[2]
