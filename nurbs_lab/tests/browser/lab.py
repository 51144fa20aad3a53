"""What a person does in JupyterLab: open a notebook, run it, look."""

import time
from contextlib import suppress
from pathlib import Path

EXPORTS = Path(__file__).parents[3] / "exports"


class Lab:
    """One notebook, open in the browser."""

    def __init__(self, chromium, server, notebook):
        self.address, self.folder = server
        self.notebook = notebook
        self.complaints = []
        self.page = chromium.new_page(viewport={"width": 1400, "height": 1000})
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("console", lambda said: said.type == "error" and self.complaints.append(said.text))
        self.page.goto(f"{self.address}/lab/tree/notebooks/{notebook}.ipynb?reset", timeout=120_000)
        self.page.wait_for_selector(".jp-Notebook .jp-Cell", timeout=120_000)

    def command(self, name, **arguments):
        """Run one of JupyterLab's own commands, without waiting for its end."""
        script = "([name, arguments]) => { window.jupyterapp.commands.execute(name, arguments); }"
        self.page.evaluate(script, [name, arguments])

    def run_all(self, timeout_s=180):
        """Clear the stored outputs, run every cell and wait for the kernel to be idle again."""
        self.wait_for_kernel()
        self.command("notebook:clear-all-cell-outputs")
        self.command("notebook:run-all-cells")
        end = time.monotonic() + timeout_s
        while time.monotonic() < end:
            self.page.wait_for_timeout(500)
            cells = self.cells()
            if (cells and all(cell["count"] for cell in cells)) or any(cell["error"] for cell in cells):
                return cells
        self.screenshot(f"{self.notebook}-late")
        raise TimeoutError(f"{self.notebook} did not finish in {timeout_s} s")

    def wait_for_kernel(self):
        """Until it does nothing."""
        kernel = "window.jupyterapp.shell.currentWidget?.sessionContext?.session?.kernel"
        self.page.wait_for_function(f"() => {kernel}?.status === 'idle'", timeout=120_000)

    def start_cell(self, index):
        """Run the cell of this number, without waiting for its end."""
        self.wait_for_kernel()
        self.page.evaluate(
            "n => { window.jupyterapp.shell.currentWidget.content.activeCellIndex = n }", index
        )
        self.command("notebook:run-cell")

    def cells(self):
        """Count, pictures, widgets, stderr and error of every code cell, from the live document model."""
        return self.page.evaluate("""() => {
            const found = [];
            for (const cell of window.jupyterapp.shell.currentWidget.content.model.cells) {
                if (cell.type !== 'code') continue;
                const outputs = cell.outputs.toJSON();
                found.push({
                    count: cell.executionState === 'running' ? null : cell.executionCount,
                    pictures: outputs.filter(o => o.data && o.data['image/png']).length,
                    widgets: outputs.filter(o => o.data &&
                        o.data['application/vnd.jupyter.widget-view+json']).length,
                    complaint: outputs.filter(o => o.name === 'stderr').map(o => o.text).join(),
                    error: outputs.filter(o => o.output_type === 'error').map(o => o.evalue).join(),
                    name: outputs.filter(o => o.output_type === 'error').map(o => o.ename).join(),
                });
            }
            return found;
        }""")

    def looks(self, pictures):
        """What the pictures show now, as addresses of their data."""
        return pictures.evaluate_all("images => images.map(image => image.src)")

    def wait_for(self, condition, timeout_s=60):
        """Let the page live until the condition holds."""
        end = time.monotonic() + timeout_s
        while not condition():
            if time.monotonic() > end:
                self.screenshot(f"{self.notebook}-late")
                raise TimeoutError(f"{self.notebook} did not change in {timeout_s} s")
            self.page.wait_for_timeout(200)

    def interrupt_until(self, condition):
        """Interrupt the kernel as a person does: again if it ignored it, as it does before the work has begun
        and as Python does where an object is being finalised."""
        for _ in range(6):
            self.command("notebook:interrupt-kernel")
            with suppress(TimeoutError):
                return self.wait_for(condition, 10)
        raise TimeoutError(f"{self.notebook} was not stopped by six interrupts")

    def go_to_cell(self, index):
        """Scroll there; JupyterLab draws only the cells in view."""
        self.page.evaluate(
            "n => window.jupyterapp.shell.currentWidget.content.scrollToItem(n, 'start')", index
        )
        self.page.wait_for_timeout(3000)

    def screenshot(self, name):
        """Leave a picture of the window in exports/."""
        EXPORTS.mkdir(exist_ok=True)
        self.page.screenshot(path=EXPORTS / f"{name}.png")
