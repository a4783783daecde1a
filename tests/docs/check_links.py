#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every file and room that the documentation names is there."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"\]\(([^)#\s]*)(?:#[^)]*)?\)")
HEADER = re.compile(r"\b(?:parts/|shared/)?([a-z]+/[a-z_0-9]+\.(?:h|cpp))\b")

wrong = []
for page in [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")]:
    text = page.read_text()
    for link in LINK.findall(text):
        if link and not re.match(r"[a-z]+:", link) and not (page.parent / link).exists():
            wrong.append(f"{page.relative_to(ROOT)}: no file {link}")
    for header in HEADER.findall(text):
        if not any((ROOT / folder / header).exists() for folder in ("shared", ".", "tests", "src")):
            wrong.append(f"{page.relative_to(ROOT)}: no source {header}")
print("\n".join(wrong) or "Every file that the documentation names is there.")
sys.exit(1 if wrong else 0)
