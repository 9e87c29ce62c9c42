#!/usr/bin/env python3
"""One table of many paintings: how good each is, what to look at, and what failed and why.

Reads the JSON that `tangipaint fit` and `mosaic` print (NAME.json), and what jobs that failed said: NAME.log beside it,
those in the folder NAME/ of its steps, and that of its page.
"""
import argparse
import csv
import html
import json
from pathlib import Path

COLUMNS = ["object", "verdict", "megapixels", "photographs", "rejected", "median residual [sigma]", "median confidence",
           "unsure pixels [%]", "seconds", "peak memory [MB]", "why"]
# The worst first: of a hundred, those are what somebody has to look at.
ORDER = ["failed", "poor", "warnings", "good"]


def numbers_of(result):
    numbers = {"megapixels": round(result["width"] * result["height"] / 1e6, 2), "seconds": round(result["seconds"], 1),
               "peak memory [MB]": round(result["peak_memory_mb"])}
    if "photographs" in result:  # of a fit, not of a mosaic
        photographs = result["photographs"]
        numbers |= {"photographs": photographs["fitted"], "rejected": len(photographs["rejected"]),
                    "median residual [sigma]": round(result["median_residual_sigma"], 2),
                    "median confidence": round(result["median_confidence"], 3),
                    "unsure pixels [%]": round(100 * result["unsure_pixels"], 1)}
    return numbers


def failures_of(path, pages):
    """What the jobs of a result and of its page said when they failed; a job that succeeded said nothing."""
    logs = [*sorted((path.parent / path.stem).rglob("*.log")), path.with_suffix(".log"), pages / f"{path.stem}.log"]
    texts = [log.read_text(encoding="utf-8", errors="replace").strip() for log in logs if log.is_file()]
    return [text for text in texts if text]


def row_of(path, pages):
    row = dict.fromkeys(COLUMNS, "") | {"object": path.stem}
    failures = failures_of(path, pages)
    if path.is_file():
        result = json.loads(path.read_text(encoding="utf-8"))
        poor, warnings = result.get("poor", []), result.get("warnings", [])
        row |= numbers_of(result)
        row |= {"verdict": "poor" if poor else "warnings" if warnings else "good", "why": " | ".join(poor or warnings)}
    elif not failures:
        failures = ["is not there, and no job said why: one was stopped or killed, or what it is made of failed; "
                    "Snakemake's log says which"]
    if failures:
        row |= {"verdict": "failed", "why": " | ".join(failures)}
    return row


def page_of(rows, pages):
    head = "".join(f"<th>{html.escape(name)}</th>" for name in COLUMNS)
    body = ""
    for row in rows:
        name = html.escape(row["object"])
        if (pages / row["object"] / "index.html").is_file() or row["verdict"] != "failed":
            name = f'<a href="pages/{name}/index.html">{name}</a>'
        cells = [name, *(html.escape(str(row[column])) for column in COLUMNS[1:])]
        body += f'<tr class="{row["verdict"]}">' + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>\n"
    failed = sum(row["verdict"] == "failed" for row in rows)
    title = f"{len(rows)} paintings" + (f", of which {failed} failed" if failed else "")
    return ('<!doctype html><html lang="en"><meta charset="utf-8"><title>Paintings</title><style>'
            "body{font:15px system-ui;margin:2em}td,th{padding:.2em .8em;text-align:left;vertical-align:top}"
            ".failed td:nth-child(2),.poor td:nth-child(2){color:#b00020;font-weight:bold}"
            ".warnings td:nth-child(2){color:#8a6d00}</style>"
            f"<h1>{title}</h1><table><thead><tr>{head}</tr></thead><tbody>\n{body}</tbody></table></html>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", nargs="+", type=Path, help="NAME.json of each; those of which a job failed are not there")
    parser.add_argument("--html", type=Path, required=True)
    parser.add_argument("--csv", type=Path, required=True)
    arguments = parser.parse_args()
    pages = arguments.html.parent / "pages"
    rows = [row_of(path, pages) for path in arguments.results]
    rows.sort(key=lambda row: (ORDER.index(row["verdict"]), -(row["median residual [sigma]"] or 0), row["object"]))
    arguments.html.parent.mkdir(parents=True, exist_ok=True)
    arguments.html.write_text(page_of(rows, pages), encoding="utf-8")
    with arguments.csv.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
