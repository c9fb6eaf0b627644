#!/bin/sh
# Runs an OpenXR program on the mock runtime, and fails where the program does, where it ends without a frame, or where it broke a
# rule of the specification, which is printed.
#
#     sh ci.sh LIBRARY SCENARIO FOLDER PROGRAM [ARGUMENT...]
#
# LIBRARY is libparafovea_mock_runtime.so, SCENARIO a TOML file. Record and pictures go to FOLDER/out.
set -eu
if [ $# -lt 4 ]; then
    echo "usage: ci.sh LIBRARY SCENARIO FOLDER PROGRAM [ARGUMENT...]" >&2
    exit 2
fi
mkdir -p "$3"
library=$(realpath "$1") scenario=$2 folder=$(realpath "$3")
shift 3
rm -rf "$folder/out" "$folder/input"
cp "$scenario" "$folder/scenario.toml"
printf '{ "file_format_version": "1.0.0", "runtime": { "name": "mock", "library_path": "%s" } }\n' \
    "$library" > "$folder/mock.json"
# An input that never ends: hello_xr, for one, quits when its input does.
mkfifo "$folder/input"
exec 3<> "$folder/input"
XR_RUNTIME_JSON=$folder/mock.json PARAFOVEA_MOCK_SCENARIO=$folder/scenario.toml "$@" <&3

record=$folder/out/record.jsonl
if ! grep -q '"kind":"frame"' "$record"; then
    echo "$1 ended without a frame" >&2
    exit 1
fi
if grep '"kind":"error"' "$record" >&2; then
    echo "$1 broke rules of the specification" >&2
    exit 1
fi
echo "$(grep -c '"kind":"frame"' "$record") frames"
