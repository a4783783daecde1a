#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every sentence that a user can meet is in tests/data/sentences.txt, to be read in one place.

"test_sentences.py write" writes that file anew. What a run fills in shows as
"…". A sentence names a cause and a remedy, begins with a capital and ends
with a full stop.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = ROOT / "tests" / "data" / "sentences.txt"
TOKEN = re.compile(r'"((?:[^"\\\n]|\\.)*)"|\'(?:[^\'\\]|\\.)\'|//[^\n]*|[A-Za-z_]\w*|\d[\w.]*|\s+|.', re.S)


def tokens(text):
    for match in TOKEN.finditer(text):
        word = match.group(0)
        if not word.isspace() and not word.startswith("//"):
            yield word


def arguments(words, start):
    """The arguments of the call whose parenthesis is words[start]."""
    depth, found = 0, [[]]
    for word in words[start:]:
        depth += (word in "([{") - (word in ")]}")
        if depth == 0:
            return found
        if depth == 1 and word == ",":
            found.append([])
        elif not (depth == 1 and word in "([{" and found == [[]]):
            found[-1].append(word)
    return []


def text_of(argument):
    """Literals as they are, everything between them as an ellipsis; both of two alternatives."""
    parts, depth = [], 0
    for word in argument:
        depth += (word in "([{") - (word in ")]}")
        if word.startswith('"') and depth == 0 or word.startswith('"') and parts == [] and len(word) > 20:
            parts.append(word[1:-1].replace('\\"', '"'))
        elif word != "+" and parts[-1:] != ["…"] and not word.startswith('"'):
            parts.append("…")
    return "".join(parts)


def sentences():
    found = {}
    sources = [f for folder in [ROOT / "shared", *ROOT.glob("filter_*")] for f in folder.rglob("*")
               if f.suffix in (".cpp", ".h")]
    for file in sorted(sources):
        words = list(tokens(file.read_text()))
        for i, word in enumerate(words[:-1]):
            if word == "UserError" and words[i + 1] == "(":
                given = arguments(words, i + 1)
                what = given[0] if given else []
            elif word == "log_value" and words[i + 1] == "(":
                given = arguments(words, i + 1)
                if len(given) < 3 or given[1] != ['"warning"']:
                    continue
                what = given[2]
            elif word == "return" and file.name == "run.cpp":  # what stopped a run
                end = words.index(";", i)
                what = [w for w in words[i + 1:end] if w not in ("std", ":", "string", "(", ")")]
                if not any(w.endswith('."') for w in what):
                    continue
            else:
                continue
            text = text_of(what)
            if re.search(r"\w", text):
                found.setdefault(text, file.relative_to(ROOT).as_posix())
    return found


def unclear(text):
    """What is wrong with a sentence's form, or nothing."""
    whole = text.strip()
    if not whole.endswith((".", "…")):
        return "does not end with a full stop"
    if not (whole[0].isupper() or whole[0] in '…"'):
        return "does not begin with a capital"
    if not re.search(r"[;:] |\. |\bmust\b|…", whole.rstrip(".")):
        return "names no remedy"
    return ""


def main():
    found = sentences()
    if sys.argv[1:] == ["write"]:
        LIST.write_text("\n".join(sorted(found)) + "\n")
        return 0
    known = set(LIST.read_text().splitlines())
    faults = [f"{file}: not in the list: {text}" for text, file in found.items() if text not in known]
    faults += [f"no source has it any more: {text}" for text in known - set(found)]
    faults += [f"{file}: {fault}: {text}" for text, file in found.items() for fault in [unclear(text)] if fault]
    print("\n".join(sorted(faults)))
    print(f"{len(found)} sentences, {len(faults)} faults")
    if faults:
        print(f"Read them, then '{pathlib.Path(__file__).relative_to(ROOT)} write' writes {LIST.relative_to(ROOT)} anew.")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
