#!/bin/sh
# Installs Parafovea for this user, or with --uninstall removes it again; nothing else is touched.
# The command goes to $PREFIX/bin; PREFIX is ~/.local unless set.
set -eu

prefix=${PREFIX:-$HOME/.local}
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
files='
bin/parafovea
lib/parafovea/parafovea-probe
lib/parafovea/libparafovea.so
lib/parafovea/libparafovea_audio.so
share/bash-completion/completions/parafovea
share/zsh/site-functions/_parafovea
share/fish/vendor_completions.d/parafovea.fish
share/man/man1/parafovea.1'

case ${1-} in
--uninstall)
    "$here/bin/parafovea" uninstall
    for file in $files; do
        rm -f -- "$prefix/$file"
    done
    [ ! -d "$prefix/lib/parafovea" ] || rmdir -- "$prefix/lib/parafovea"
    echo "removed from $prefix; configuration and logs stay"
    exit
    ;;
'') ;;
*)
    echo "usage: $0 [--uninstall]" >&2
    exit 2
    ;;
esac

# A second installation is refused, before any file is copied.
"$here/bin/parafovea" install --dry-run >/dev/null

for file in $files; do
    if [ ! -e "$here/$file" ]; then
        rm -f -- "$prefix/$file"
        continue
    fi
    mkdir -p -- "$(dirname -- "$prefix/$file")"
    # By way of another name: a program that runs keeps the file that it has.
    cp -- "$here/$file" "$prefix/$file.new"
    mv -f -- "$prefix/$file.new" "$prefix/$file"
done
"$prefix/bin/parafovea" install
case :$PATH: in
*":$prefix/bin:"*) command=parafovea ;;
*) command=$prefix/bin/parafovea ;;
esac
echo "Next, check the installation: $command doctor"
echo "To play: $command run -- GAME"
