"""The documentation as a site: it builds, and no link of it leads nowhere."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.deep
def test_its_links_hold(command: str, tmp_path: Path) -> None:
    pytest.importorskip("mkdocs", reason="the site needs pip install softkin[docs]")
    pytest.importorskip("latex2mathml", reason="the site needs pip install softkin[docs]")
    pages, site = tmp_path / "pages", tmp_path / "site"
    script = [sys.executable, str(ROOT / "scripts/site.py"), str(pages), "--program", command, "--without-robots"]
    done = subprocess.run(script, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    settings = (ROOT / "mkdocs.yml").read_text().replace("build-docs/pages", str(pages)).replace("build-docs/site", str(site))
    (tmp_path / "mkdocs.yml").write_text(settings)
    build = [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", str(tmp_path / "mkdocs.yml")]
    done = subprocess.run(build, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    commands = (site / "reference/commands.html").read_text()
    assert "softkin calibrate pressure" in commands and "--html" in commands
    assert "<math" in (site / "theory.html").read_text()
    headers = (pages / "reference/cpp.md").read_text()
    assert "### softkin/runs/jobs.hpp" in headers and "\n[[nodiscard]] Model compile(const RobotSpec& spec);\n" in headers
    assert "private:" not in headers and "return " not in headers
    for file in site.rglob("*.html"):  # it fetches nothing
        assert not re.findall(r'(?:src|<link[^>]*href)="https?:', file.read_text()), file.name
    (pages / "walking.md").write_text("[nowhere](nowhere.md)")
    assert subprocess.run(build, capture_output=True).returncode != 0
