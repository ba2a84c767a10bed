# Figures of a text from result files: awk -f figures.awk -v results=FOLDER TEXT
#
# "<!-- figure: FILE COLUMN ROW -->...<!-- end -->" within a line: what stands between becomes the value in the column of that name,
# in the one row of FOLDER/FILE (tab-separated, a header line) that has the words ROW next to each other. Blocks between lines of
# ``` are left alone.
# A file, a column or a row that is not there, and a row that is not the only one, are errors: status 1.

/^```/ { inside = !inside }
inside { print; next }
{
    line = $0
    text = ""
    while (match(line, /<!-- figure: [^>]* -->/)) {
        mark = substr(line, RSTART, RLENGTH)
        text = text substr(line, 1, RSTART - 1) mark
        line = substr(line, RSTART + RLENGTH)
        end = index(line, "<!-- end -->")
        if (!end) fail("no <!-- end --> after " mark)
        text = text figure(substr(mark, 14, length(mark) - 17))
        line = substr(line, end)
    }
    print text line
}

function figure(mark,    word, i, row, file, found, value) {
    split(mark, word, " ")
    file = word[1]
    row = substr(mark, length(word[1]) + length(word[2]) + 3)
    read_table(file)
    if (!((file, word[2]) in column)) fail(file ": no column " word[2])
    for (i = 1; i <= rows[file]; i++)
        if (index(words[file, i], " " row " ")) {
            value = cell[file, i, column[file, word[2]]]
            found++
        }
    if (found != 1) fail(file ": " found + 0 " rows with: " row)
    return value
}

function read_table(file,    path, line, part, n, i, count) {
    if (file in rows) return
    path = results "/" file
    while ((getline line < path) > 0) {
        n = split(line, part, "\t")
        for (i = 1; i <= n; i++) {
            if (count == 0) column[file, part[i]] = i
            cell[file, count + 0, i] = part[i]
        }
        gsub(/[\t, ]+/, " ", line)
        words[file, count + 0] = " " line " "
        count++
    }
    close(path)
    if (count == 0) fail("no " path)
    rows[file] = count - 1
}

function fail(message) {
    print "figures: " message > "/dev/stderr"
    exit 1
}
