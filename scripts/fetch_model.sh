#!/usr/bin/env bash
# Fetches official YOLOX weights (Apache-2.0, Megvii) to where dkp-slam looks for them.
set -euo pipefail

release=https://github.com/Megvii-BaseDetection/YOLOX/releases/download/0.1.1rc0
default_folder=${XDG_CACHE_HOME:-$HOME/.cache}/dkp-slam

usage() {
  cat <<TEXT
usage: $(basename "$0") [nano|tiny|s] [FOLDER]

  nano   416x416, 3.7 MB (default; about 15 ms an image on one core)
  tiny   416x416, 20 MB
  s      640x640, 36 MB (the paper's)

FOLDER is $default_folder unless given. dkp-slam looks there, in models/ of the current
folder, in models/ beside the program and, installed, in PREFIX/share/dkp-slam/models; --model or
DKP_SLAM_MODEL names any other place.
TEXT
}

# The release publishes no checksums; these are those that several independent projects have
# recorded for the files of this release.
case "${1:-nano}" in
  nano) sum=c789161ed43c8269fcd4e67c67eeeb4e80c622da2eb296a20bc6007bd18a0b7d ;;
  tiny) sum=427cc366d34e27ff7a03e2899b5e3671425c262ea2291f88bb942bc1cc70b0f7 ;;
  s) sum=c5c2d13e59ae883e6af3b45daea64af4833a4951c92d116ec270d9ddbe998063 ;;
  -h|--help) usage; exit 0 ;;
  *) echo "$(basename "$0"): no model '$1'" >&2; usage >&2; exit 2 ;;
esac
name=yolox_${1:-nano}.onnx
folder=${2:-$default_folder}
file=$folder/$name

matches() { echo "$sum  $1" | sha256sum --check --status; }

if [ -f "$file" ] && matches "$file"; then
  echo "$file is there already, checksum right"
  exit 0
fi
mkdir -p "$folder"
# Downloaded beside its place and moved when whole and checked.
part=$(mktemp "$folder/.$name.XXXXXX")
trap 'rm -f "$part"' EXIT
if ! curl --fail --location --silent --show-error --retry 3 --connect-timeout 20 \
     --output "$part" "$release/$name"; then
  cat >&2 <<TEXT
fetch_model.sh: could not fetch $release/$name
  Without a network: fetch it on another machine, put it at $file,
  and check it: sha256sum must give $sum
  dkp-slam also runs without a model: its motion detector finds what moves by itself.
TEXT
  exit 1
fi
if ! matches "$part"; then
  echo "fetch_model.sh: $name has sha256 $(sha256sum "$part" | cut -d' ' -f1)," >&2
  echo "  not $sum; not kept" >&2
  exit 1
fi
chmod 644 "$part"
mv "$part" "$file"
trap - EXIT
echo "$file fetched, checksum right"
