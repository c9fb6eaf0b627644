#!/bin/sh
# In place of a Python interpreter in tests. The name by which it is called is that of its defect:
# without-pyfvvdp, of-another-version, failing, talkative; by any other name it has none.
# It finds no difference in equal clips, and in others differences of 1, 1/4, 1/9 ... in frame after frame.
name=$(basename "$0")
if [ "$1" = -c ]; then
    case $name in
    without-pyfvvdp)
        echo "Traceback (most recent call last):" >&2
        echo "ModuleNotFoundError: No module named 'pyfvvdp'" >&2
        exit 1 ;;
    of-another-version) echo 1.1.3 ;;
    *) echo 1.2.2 ;;
    esac
    exit 0
fi
[ -s "$1" ] || exit 2
case $name in
failing)
    echo "RuntimeError: no memory" >&2
    exit 1 ;;
talkative) echo "a warning" ;;
esac
folder=$(dirname "$2")
field() { sed -n "s/.*\"$1\":\([0-9]*\).*/\1/p" "$2"; }
frames=$(field frames "$2")
bytes=$((frames * $(field width "$2") * $(field height "$2") * 3))
for clip in reference test; do
    [ "$(wc -c < "$folder/$clip.rgb")" -eq "$bytes" ] || exit 3
done
equal=0
cmp -s "$folder/reference.rgb" "$folder/test.rgb" && equal=1
awk -v frames="$frames" -v equal="$equal" 'BEGIN {
    for (frame = 1; frame <= frames; frame++) {
        difference = equal ? 0 : 1 / (frame * frame)
        sum += difference
        list = list (frame > 1 ? ", " : "") difference
    }
    printf "{\"jod\": %.6f, \"version\": \"1.2.2\", \"by_frame\": [%s], \"exponent\": 0.5}\n", 10 - sqrt(sum / frames), list
}'
