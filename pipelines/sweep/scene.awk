# The scene of one case: awk -f scene.awk -v wanted=CASE -v folder=FOLDER -v stream=STREAM CASES TEMPLATE
#
# CASES: a line of names separated by tabs, the first of them "case", then a line for each case; lines that begin with # are comments.
# TEMPLATE: a scene with @NAME@ where the value of column NAME belongs. Relative names of files in the scene are led by FOLDER. The first
# line that is written is "# stream " and STREAM, whose @NAME@ are replaced as well. With -v list=1, only the names of the cases, each of
# them checked. wanted="row=N": the Nth case, from 1. Status 2 and one line for whatever is wrong.

BEGIN { FS = "\t" }

FNR == 1 { file = FILENAME == ARGV[1] ? 1 : 2 }
{ sub(/\r$/, "") }

file == 1 && (/^#/ || /^[ \t]*$/) { next }
file == 1 && columns == 0 { head(); next }
file == 1 { row(); next }
{ template[++lines] = $0 }

END {
    if (failed) exit 2
    if (columns == 0) die(ARGV[1] ": no line of names")
    if (cases == 0) die(ARGV[1] ": no cases below the line of names")
    if (lines == 0) die(ARGV[2] ": empty, or not there")
    if (substr(wanted, 1, 4) == "row=") {
        if (!(substr(wanted, 5) in name_of)) die(ARGV[1] ": no " wanted ": there are " cases " cases")
        wanted = name_of[substr(wanted, 5)]
    }
    if (!list && !(wanted in number)) die(ARGV[1] ": no case '" wanted "'")
    stream = "# stream " filled(stream, "the stream's name")
    for (i = 1; i <= lines; i++) scene[i] = filled(place(template[i]), ARGV[2] ": line " i)
    for (i = 2; i <= columns; i++)
        if (!(i in used)) die(ARGV[1] ": column '" title[i] "' is nowhere in " ARGV[2] ": write @" title[i] "@ there, or take the column away")
    if (list) {
        for (i = 1; i <= cases; i++) print name_of[i]
        exit
    }
    print stream
    for (i = 1; i <= lines; i++) print scene[i]
}

function head(    i) {
    columns = split($0, title)
    if (title[1] != "case") die(FILENAME ": line " FNR ": the first column is called '" title[1] "', not case")
    for (i = 1; i <= columns; i++) {
        if (title[i] !~ /^[A-Za-z0-9_.-]+$/) die(FILENAME ": line " FNR ": '" title[i] "' is no name for a column: letters, digits, . _ -")
        if (title[i] in column) die(FILENAME ": line " FNR ": two columns are called '" title[i] "'")
        column[title[i]] = i
    }
}

function row(    i) {
    if (NF != columns) die(FILENAME ": line " FNR ": " NF " values, but " columns " columns")
    if ($1 !~ /^[A-Za-z0-9_][A-Za-z0-9_.-]*$/) die(FILENAME ": line " FNR ": '" $1 "' is no name for a case: letters, digits, . _ -")
    if ($1 in number) die(FILENAME ": line " FNR ": a second case '" $1 "'")
    number[$1] = ++cases
    name_of[cases] = $1
    if ($1 == wanted || "row=" cases == wanted) for (i = 1; i <= columns; i++) value[i] = $i
}

# A line with the values of the case in place of @NAME@.
function filled(line, where,    out, from, to, name) {
    out = ""
    while ((from = index(line, "@")) > 0) {
        to = index(substr(line, from + 1), "@")
        name = substr(line, from + 1, to - 1)
        if (to == 0 || !(name in column)) die(where ": '@" name "' is no column of " ARGV[1])
        used[column[name]] = 1
        out = out substr(line, 1, from - 1) value[column[name]]
        line = substr(line, from + to + 1)
    }
    return out line
}

# Keys that name files, which scenes take relative to themselves.
function place(line,    parts, key, file_name) {
    if (line ~ /^[ \t]*[#;]/) return ""
    if (split(line, parts, "=") < 2) return line
    key = parts[1]
    gsub(/[ \t]/, "", key)
    file_name = substr(line, index(line, "=") + 1)
    gsub(/^[ \t]+|[ \t]+$/, "", file_name)
    if (key != "table" && key != "rigid" && key != "curve" || file_name ~ /^\//) return line
    if (key == "curve" && (file_name == "smooth" || file_name == "linear" || file_name == "step")) return line
    return key " = " folder "/" file_name
}

function die(message) {
    if (!failed) print "sweep: " message > "/dev/stderr"
    failed = 1
    exit 2
}
