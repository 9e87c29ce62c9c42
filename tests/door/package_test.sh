#!/usr/bin/env bash
# Packages work where nothing is but a system: both are made, and the sample is fitted with them in roots of debootstrap.
# Usage: package_test.sh SOURCE_FOLDER BUILD_FOLDER; as root, with the network that apt uses. TP_PACKAGES_MADE=1 takes those
# that are in out/packages already.
set -euo pipefail
source=$(realpath "$1")
build=$(realpath "$2")
if [ "$(id -u)" -ne 0 ]; then
    echo "package_test.sh: debootstrap and chroot need root" >&2
    exit 1
fi
[ "${TP_PACKAGES_MADE:-}" = 1 ] || "$source/script/package" --build "$build"
packages=$source/out/packages
deb=$(ls "$packages"/*.deb) archive=$(ls "$packages"/*.tar.gz)
lintian --allow-root --fail-on error --tag-display-limit 0 "$deb"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mirror=$(apt-get indextargets --format '$(REPO_URI)' | grep -v security | head -1)
debootstrap --variant=minbase "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$work/plain" "$mirror" >"$work/log" ||
    { cat "$work/log" >&2; exit 1; }
cp -a "$work/plain" "$work/with_deb"

# A chroot with /proc, by which a program, and the loader, know where they lie; it is gone with the command.
inside() { # ROOT COMMAND …
    unshare --mount --pid --fork --mount-proc="$1/proc" chroot "$@"
}

fits() { # ROOT PROGRAM
    inside "$1" env -i PATH=/usr/bin:/bin HOME=/root "$2" demo --small --out /tmp/demo --quiet >"$work/result"
    grep -q '"fitted_pixels": [1-9]' "$work/result"
    [ -s "$1/tmp/demo/contact_sheet.png" ]
}

tar -C "$work/plain/opt" -xzf "$archive"
fits "$work/plain" "/opt/$(basename "$archive" .tar.gz)/bin/tangipaint"
echo "the archive runs"

# What apt here knows of mirrors, it knows there.
cp -a /etc/apt/. "$work/with_deb/etc/apt/"
cp /etc/resolv.conf "$work/with_deb/etc/resolv.conf"
cp "$deb" "$work/with_deb/tmp/tangipaint.deb"
inside "$work/with_deb" env DEBIAN_FRONTEND=noninteractive sh -c \
    'apt-get update -q && apt-get install -q -y --no-install-recommends /tmp/tangipaint.deb python3-numpy' >"$work/log" ||
    { tail -20 "$work/log" >&2; exit 1; }
fits "$work/with_deb" /usr/bin/tangipaint
inside "$work/with_deb" python3 -c 'import tangipaint; print("the module runs:", tangipaint.__version__)'
echo "the package runs"
