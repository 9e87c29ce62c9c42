#!/usr/bin/env bash
# README stays true: every command of its ```sh fences runs, every file that it links to is there, and so are the
# scripts that it promises. Usage: readme_test.sh SOURCE_FOLDER PROGRAM
set -euo pipefail
source=$(realpath "$1")
program=$(realpath "$2")
failed=0

complain() {
    echo "FAILED: $*" >&2
    failed=1
}

for script in script/bootstrap script/commands-page script/demo script/figures-capture script/test script/screenshots \
    script/retouching_pictures .ci/run; do
    [ -x "$source/$script" ] || complain "$script is not there, or cannot be run"
    [[ $(head -n 1 "$source/$script") == *python3 ]] || bash -n "$source/$script" || complain "$script: bash cannot read it"
done

# Whoever asks a script what it does does not want it to build for minutes.
for script in script/commands-page script/demo script/test script/screenshots script/retouching_pictures; do
    timeout 10 "$source/$script" --help | grep -q "Usage: $script" || complain "$script --help does not say how to use it"
done

lines=$(wc -l <"$source/README.md")
[ "$lines" -le 100 ] || complain "README.md has $lines lines, of 100"

links=$(grep -o '](\([^)]*\))' "$source/README.md" | sed 's/^](//; s/)$//; s/#.*//' | grep -v '^[a-z]*:' | sort -u)
[ -n "$links" ] || complain "README.md: no links found; has the way they are written changed?"
for link in $links; do
    [ -e "$source/$link" ] || complain "README.md links to $link, which is not there"
done

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin" "$folder/home"
ln -s "$program" "$folder/bin/tangipaint"
cd "$folder/home"
# The commands are for the sample; here they get a part of it, cut out, as all of it would take minutes and show no
# more: the part that has most of its losses, which are found and filled.
sample=datasets/impasto/jpg
mkdir -p "$sample"
cp "$source/$sample"/*.lp "$sample"
for photo in "$source/$sample"/*.jpg; do
    oiiotool "$photo" --cut 160x160+315+268 --quality 95 -o "$sample/${photo##*/}"
done
ln -s "$source/datasets/strokes" datasets/strokes
export PATH="$folder/bin:$PATH"

commands=0
while IFS= read -r line; do
    [ -n "$line" ] || continue
    commands=$((commands + 1))
    echo "+ $line"
    started=$SECONDS
    if bash -o pipefail -c "$line" >"$folder/stdout" 2>"$folder/stderr" </dev/null; then
        echo "  $((SECONDS - started)) s"
    else
        complain "README.md: exit code $? from: $line"
        cat "$folder/stderr" >&2
    fi
done < <(awk '/^```sh$/ { inside = 1; next } /^```/ { inside = 0 } inside' "$source/README.md")

[ "$commands" -ge 9 ] || complain "README.md: only $commands commands found; has the way they are written changed?"
for result in painting.exr raking.png report/compare.html report/compare.json relit/heldout_005.png \
    eighth/compare.html eighth.html raking.mp4 page/index.html painting.ptm again.exr synthetic/lights.lp synthetic.exr \
    still_life.png cards.png damage.png treatment.pdf swatches.png; do
    [ -s "$result" ] || complain "the commands of README.md did not make $result"
done
[ "$failed" -eq 0 ] && echo "README.md: all $commands commands run"
exit "$failed"
