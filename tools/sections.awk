# The tables of sections of lib/README.md into a man page, at its line `.\" sections`: awk -f sections.awk lib/README.md PAGE

# Markdown to roff: code in bold.
function roff(text) {
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    while (match(text, /`[^`]*`/))
        text = substr(text, 1, RSTART - 1) "\\fB" substr(text, RSTART + 1, RLENGTH - 2) "\\fR" substr(text, RSTART + RLENGTH)
    return text ~ /^[.']/ ? "\\&" text : text
}

FNR == NR {
    if (/^N nodes/) on = 1
    if (!on) next
    if (/^\| *(section|---)/ || /^\|-/) next
    if (/^\|/) {
        split($0, column, / *\| */)
        text = text ".TP\n" roff(column[2]) " (" roff(column[3]) (column[4] != "" ? "; " roff(column[4]) : "") "; " \
            roff(column[5]) ")\n" roff(column[6]) "\n"
    } else {
        text = text (/^$/ ? ".PP" : roff($0)) "\n"
    }
    next
}
/^\.\\" sections$/ { printf "%s", text; told = 1; next }
{ print }
END { if (!told) exit 1 }
