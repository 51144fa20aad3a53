"""Branches of the Verilog that the benches reach: ``make branches``.

The benches run on a copy of each module in which every condition of ``if`` and ``?:`` passes through a
function, and every arm of a ``case`` calls it; the function prints each value that it meets once. A branch
is one value of a condition, or one arm. What chooses at elaboration (``generate``, ``localparam``) is not
counted.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VERILOG = [*sorted((ROOT / "rtl").glob("*.v")), *sorted((ROOT / "rtl" / "boards").glob("*.v"))]
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
CONSTANT = re.compile(r"(\blocalparam\b[^;]*;|\b(?:if|for) \([^\n]*begin)")
ALWAYS = re.compile(r"\balways @\s*(?:\*|\([^)]*\))")
MARK = re.compile(r"@reach (\w+) (\d+) ([01])")
PROBE = """
    reg [{last}:0] reach_seen = 0;
    reg reach_arm;
    function reach(input integer branch, input value);
        begin
            reach = value;
            if (value === 1'b0 || value === 1'b1) if (!reach_seen[2 * branch + value]) begin
                reach_seen[2 * branch + value] = 1'b1;
                $display("@reach {name} %0d %b", branch, value);
            end
        end
    endfunction
"""


class Module:
    """A module with probes: ``text`` to compile, and ``branches`` as (source, value) in their order."""

    def __init__(self, file: Path):
        self.name, self.probes = file.stem, []
        head, self.rest = re.match(r"(.*?\n\);)(.*)", COMMENT.sub("", file.read_text()), re.DOTALL).groups()
        body = ""
        while always := ALWAYS.search(self.rest):
            body += self.outside(self.rest[: always.start()]) + always[0]
            self.rest = self.rest[always.end() :]
            body += self.statement()
        body += self.outside(self.rest)
        self.text = head + PROBE.format(last=2 * len(self.probes) + 1, name=self.name) + body

    @property
    def branches(self):
        return [(i, value) for i, (_, values) in enumerate(self.probes) for value in values]

    def probe(self, source, values="01"):
        source = re.sub(r"\breach\(\d+, \|\(([^()]*)\)\)", r"\1", source)
        self.probes.append((" ".join(source.split()), values))
        return len(self.probes) - 1

    def outside(self, text):
        """Declarations, assignments and instances."""
        parts = enumerate(CONSTANT.split(text))
        return "".join(part if i % 2 else self.expression(part) for i, part in parts)

    def expression(self, text):
        """Probes on the conditions of ``?:``, the innermost left one first."""
        done = ""
        while "?" in text:
            before, text = text.split("?", 1)
            before = done + before  # a condition may hold one that is done, in parentheses
            start = self.start_of(before)
            done = f"{before[:start]} reach({self.probe(before[start:])}, |({before[start:]}))?"
        return done + text

    @staticmethod
    def start_of(text):
        """Where the expression at the end of a text begins."""
        depth = 0
        for i in range(len(text) - 1, -1, -1):
            depth += (text[i] in ")]}") - (text[i] in "([{")
            plain = text[i] == "=" and text[i - 1] not in "=!<>" and text[i + 1 : i + 2] != "="
            if depth < 0 or (depth == 0 and (text[i] in ",:?;" or plain)):
                return i + 1
        return 0

    def take(self, pattern):
        """Cut a pattern off the front of what is left, if it is there."""
        found = re.match(r"\s*" + pattern, self.rest, re.DOTALL)
        self.rest = self.rest[found.end() :] if found else self.rest
        return found and found[0]

    def parenthesis(self):
        """What stands in the parenthesis that comes next."""
        self.take(r"\(")
        depth, end = 1, 0
        while depth:
            depth += {"(": 1, ")": -1}.get(self.rest[end], 0)
            end += 1
        text, self.rest = self.rest[: end - 1], self.rest[end:]
        return text

    def statement(self):
        if self.take(r"begin\b"):
            text = " begin"
            while not self.take(r"end\b"):
                text += self.statement()
            return text + "\nend"
        if self.take(r"if\b"):
            condition = self.parenthesis()
            number = self.probe(condition)
            text = f"\nif (reach({number}, |({self.expression(condition)})))" + self.statement()
            return text + (" else" + self.statement() if self.take(r"else\b") else "")
        if self.take(r"case\b"):
            text = f"\ncase ({self.expression(self.parenthesis())})"
            while not self.take(r"endcase\b"):
                label = self.take(r"(?:\{[^}]*\}|[\w', ]+):")
                number = self.probe(label, "1")
                text += f"{label} begin reach_arm = reach({number}, 1'b1);" + self.statement() + " end"
            return text + "\nendcase"
        target, sign, value = re.match(r"(.*?)(<=|=|;)(.*)", self.take(r"[^;]*;"), re.DOTALL).groups()
        return target + sign + self.expression(value)


def probed(folder: Path) -> list[Path]:
    """The Verilog with probes, written into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    found = []
    for file in VERILOG:
        found.append(folder / file.name)
        found[-1].write_text(Module(file).text)
    return found


def results(logs, files=VERILOG) -> dict:
    """Module -> (number of branches, those that no log tells of, as ``condition is value``)."""
    seen = {mark for log in logs for mark in MARK.findall(log.read_text())}
    found = {}
    for file in files:
        module = Module(file)
        left = [(i, value) for i, value in module.branches if (module.name, str(i), value) not in seen]
        found[module.name] = len(module.branches), [f"{module.probes[i][0]} is {v}" for i, v in left]
    return found


def table(found: dict) -> str:
    """The results in Markdown; modules without a branch are left out."""
    rows = [f"| `{name}` | {count} | {count - len(left)} |" for name, (count, left) in found.items() if count]
    return "\n".join(["| module | branches | reached |", "| --- | ---: | ---: |", *rows])


if __name__ == "__main__":
    found = results((ROOT / "sim_build").glob("*/branches.log"))
    readme = ROOT / "rtl" / "README.md"
    marked = re.compile(r"(<!-- branches -->\n).*?(<!-- end of branches -->)", re.DOTALL)
    readme.write_text(marked.sub(lambda place: f"{place[1]}{table(found)}\n{place[2]}", readme.read_text()))
    missed = [f"{name}: {branch}" for name, (_, left) in found.items() for branch in left]
    sys.exit("\n".join(["not reached:", *missed]) if missed else 0)
