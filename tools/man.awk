# The usage text of a tool (TOOL -h) to its man page: awk -f man.awk
#
# The text: "NAME - summary"; "usage: ..." and further forms below it; then blocks between blank lines. A block may
# begin with its heading, one or two words and a colon. Indented lines are a list (item, two or more blanks, text; more text
# indented deeper) or, where no line has two blanks inside, lines to print as they are.

# Protect what roff would interpret.
function escape(text) {
    gsub(/\\/, "\\e", text)
    gsub(/\^/, "\\(ha", text)
    gsub(/~/, "\\(ti", text)
    gsub(/`/, "\\(ga", text)
    gsub(/-/, "\\-", text)
    if (text ~ /^[.']/) text = "\\&" text
    return text
}

# Options in bold, VALUES in italics.
function decorate(text,    result, word, last) {
    result = ""
    last = ""
    while (match(text, /-?-?[A-Za-z0-9_][-A-Za-z0-9_.]*/)) {
        word = substr(text, RSTART, RLENGTH)
        result = result escape_inner(substr(text, 1, RSTART - 1))
        if (word ~ /^-/) word = "\\fB" escape_inner(word) "\\fR"
        else if (word ~ /^[A-Z][A-Z0-9_]*$/) word = "\\fI" word "\\fR"
        else word = escape_inner(word)
        result = result word
        text = substr(text, RSTART + RLENGTH)
    }
    result = result escape_inner(text)
    return result ~ /^[.']/ ? "\\&" result : result
}

function escape_inner(text) {
    text = escape(text)
    sub(/^\\&/, "", text)
    return text
}

function indent(text) {
    match(text, /^ */)
    return RLENGTH
}

# Lines from..to of the block as they are.
function print_verbatim(from, to,    i) {
    print ".EX"
    for (i = from; i <= to; i++) print escape(substr(block[i], 3))
    print ".EE"
}

# Lines from..to of the block as a list of items.
function print_list(from, to,    i, line, text, behind) {
    for (i = from; i <= to; i++) {
        line = block[i]
        text = substr(line, indent(line) + 1)
        if (indent(line) > 6) {
            print escape(text)
            continue
        }
        print ".TP"
        if (match(text, /   *[^ ]/)) {
            behind = substr(text, RSTART + RLENGTH - 1)
            print decorate(substr(text, 1, RSTART - 1))
            print escape(behind)
        } else {
            print decorate(text)
        }
    }
}

# Are lines from..to a list? Then some line has an item and, behind two blanks, its text.
function is_list(from, to,    i) {
    for (i = from; i <= to; i++)
        if (indent(block[i]) <= 6 && block[i] ~ /^  +[^ ](.*[^ ])?   *[^ ]/) return 1
    return 0
}

function print_block(    i, first) {
    i = 1
    if (block[1] ~ /^[A-Z][A-Za-z]*( [a-z]+)?:$/) {
        if (block[1] == "Examples:" && !has_status) print_status()
        print ".SH " toupper(substr(block[1], 1, length(block[1]) - 1))
        if (block[1] == "Exit status:") has_status = 1
        i = 2
    } else if (block[1] !~ /^ / && !after_heading) {
        print ".PP"
    }
    after_heading = 0
    while (i <= lines) {
        first = i
        if (block[i] !~ /^ /) {
            print escape(block[i++])
            continue
        }
        while (i <= lines && block[i] ~ /^ /) i++
        if (is_list(first, i - 1)) print_list(first, i - 1)
        else print_verbatim(first, i - 1)
    }
    if (block[1] == "Options:") print_common_options()
}

# Of the options that tool.c gives to every tool.
function print_common_options() {
    print ".TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nprint this text and stop"
    print ".TP\n\\fB\\-\\-version\\fR\nprint name and version and stop"
}

# Where the text has no block of that name.
function print_status() {
    print ".SH EXIT STATUS"
    print "0 good; 1 a verdict: differs, diverged, singular, invalid; 2 wrong usage or malformed input;"
    print "3 input, output or memory failed."
}

function print_synopsis(    i, text) {
    print ".SH SYNOPSIS"
    print ".nf"
    for (i = 1; i <= lines; i++) {
        text = substr(block[i], 8)
        sub("^" tool, "\001", text)
        text = decorate(text)
        sub("\001", "\\fB" tool "\\fR", text)
        print text
    }
    print ".fi"
    print ".SH DESCRIPTION"
    after_heading = 1
}

# Other pages that the text names, as PAGE(5) or, of section 1, as "see PAGE", for SEE ALSO.
function note_pages(text,    page) {
    while (match(text, /see [a-z][-a-z]*(\([1-9]\))?/)) {
        page = substr(text, RSTART + 4, RLENGTH - 4)
        text = substr(text, RSTART + RLENGTH)
        if (page !~ /\(/) page = page "(1)"
        if (page ~ /^mts\(/ || page in noted) continue
        noted[page] = 1
        pages[page ~ /\(1/] = pages[page ~ /\(1/] ".BR " escape(substr(page, 1, length(page) - 3)) " " substr(page, length(page) - 2) ",\n"
    }
}

function end_block() {
    if (lines == 0) return
    if (block[1] ~ /^usage: /) print_synopsis()
    else print_block()
    lines = 0
}

NR == 1 {
    tool = $1
    print ".TH " toupper(tool) " 1 \"\" mtled"
    print ".SH NAME"
    sub(/^[^ ]* - /, "")
    print tool " \\- " escape($0)
    next
}
/^ *$/ { end_block(); next }
{
    block[++lines] = $0
    note_pages($0)
}

END {
    end_block()
    print ".SH SEE ALSO"
    print pages[1] (tool == "mts" ? "" : ".BR mts (1),\n") pages[0] ".BR mts (5)"
}
