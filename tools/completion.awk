# The usage text of a tool (TOOL -h) to bash completion for it: awk -f completion.awk
#
# Completed are the options of the block "Options:", the commands of usage lines "TOOL COMMAND ...", and the values of
# options that are a choice: "a, b or c" where the option is explained. All else is left to bash: names of files.

# The words of a choice in an explanation, with blanks between; "" when there is none.
function choice(text,    words) {
    gsub(/ \(default\)/, "", text)
    if (!match(text, /([a-z0-9]+, )*[a-z0-9]+ or [a-z0-9]+/)) return ""
    words = substr(text, RSTART, RLENGTH)
    gsub(/,| or/, "", words)
    return words
}

# The option that was read last takes a value: its choice, from its explanation.
function end_option(    words) {
    if (pattern != "" && takes_value) {
        words = choice(explanation)
        if (words != "") cases = cases "        " pattern ") COMPREPLY=($(compgen -W '" words "' -- \"$word\")) && return ;;\n"
    }
    pattern = ""
}

# An item "-f, --format FORMAT  explanation" or "    --jitter FRACTION  explanation"; "..." behind a value: may be repeated.
function begin_option(line,    item, rest, parts, count, i) {
    end_option()
    sub(/^ +/, "", line)
    item = line
    explanation = ""
    if (match(line, /   */)) {
        item = substr(line, 1, RSTART - 1)
        explanation = substr(line, RSTART + RLENGTH)
    }
    gsub(/,( |$)/, " ", item)
    count = split(item, parts, " ")
    takes_value = 0
    for (i = 1; i <= count; i++) {
        if (parts[i] !~ /^-/) {
            takes_value = 1
            continue
        }
        pattern = pattern (pattern == "" ? "" : " | ") parts[i]
        options = options " " parts[i]
    }
}

NR == 1 { tool = $1 }
/^usage:/ { usage = 1 }
/^$/ { usage = 0; if (in_options) end_option(); in_options = 0 }
usage {
    line = $0
    sub(/^usage:/, "", line)
    split(line, word, " ")
    if (word[1] == tool && word[2] ~ /^[a-z]+$/) commands = commands " " word[2]
}
in_options && /^ +-/ && match($0, /^ */) && RLENGTH <= 6 { begin_option($0); next }
in_options { sub(/^ +/, ""); explanation = explanation " " $0 }
/^Options:$/ { in_options = 1 }

END {
    end_option()
    print "# bash completion for " tool ", made from its usage text"
    print "_mtled_" tool "() {"
    print "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}"
    print "    COMPREPLY=()"
    if (cases != "") printf "    case $before in\n%s    esac\n", cases
    print "    case $word in"
    print "        -*) COMPREPLY=($(compgen -W '" substr(options, 2) " -h --help --version' -- \"$word\")) ;;"
    if (commands != "")
        print "        *) [ \"$COMP_CWORD\" -gt 1 ] || COMPREPLY=($(compgen -W '" substr(commands, 2) "' -- \"$word\")) ;;"
    print "    esac"
    print "}"
    print "complete -o default -F _mtled_" tool " " tool
}
