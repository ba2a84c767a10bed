#!/bin/bash
# chroot.sh BASE WORK: the lines of Containerfile, read from it, each stage in a copy of BASE below WORK; BASE is a bare Debian, by
# debootstrap --variant=minbase bookworm BASE http://deb.debian.org/debian. As root. Times and sizes are printed.
set -eu -o pipefail
base=$(realpath "$1") work=$2
cd "$(dirname "$0")/../.."
mkdir -p "$work"
stages=0
sed -e ':more' -e '/\\$/ { N; s/\\\n//; b more' -e '}' -e '/^#/d; /^$/d' pipelines/install/Containerfile > "$work/lines"
while read -r instruction line <&3; do
    printf '%s %s\n' "$instruction" "$line"
    begin=$SECONDS
    case $instruction in
    FROM)
        stages=$((stages + 1))
        name=$stages
        [[ $line != *' AS '* ]] || name=${line##* AS }
        rm -rf "${work:?}/$name"
        cp -a "$base" "$work/$name"
        cp /etc/resolv.conf "$work/$name/etc/"
        ;;
    RUN) env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive chroot "$work/$name" /bin/sh -c "$line" ;;
    COPY)
        read -ra word <<< "$line"
        from=.
        [[ ${word[0]} != --from=* ]] || from=$work/${word[0]#--from=} word=("${word[@]:1}")
        to=$work/$name/${word[1]}
        if [ "$from" = . ]; then
            mkdir -p "$to"
            tar -C "${word[0]}" --exclude=./build* --exclude=./.git -cf - . | tar -C "$to" -xf -
        else
            # shellcheck disable=SC2086 # a pattern
            cp -a "$from"${word[0]} "$to"
        fi
        ;;
    esac
    printf '%s: %d s, %s\n' "$instruction" $((SECONDS - begin)) "$(du -sh "$work/$name" | cut -f 1)"
done 3< "$work/lines"
