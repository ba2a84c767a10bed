# Reading a stream in text form (mts(5)), for the programs of pipelines/: awk -f pipelines/stream.awk -f PROGRAM ...

# Read FILE ("-": standard input) into the globals rows[P S], cols[P S], attribute[P S, KEY] and, for rows and columns
# from 0, value[P S, ROW, COLUMN]; P is a prefix that tells streams apart ("" where one is read), S a section's name.
function read_stream(file, prefix,    line, field, count, section, row, i, ended, pair) {
    section = ""
    ended = -1
    while ((getline line < file) > 0) {
        count = split(line, field)
        if (count == 0) continue
        if (field[1] != "#") {
            for (i = 1; i <= count; i++) value[section, row, i - 1] = field[i]
            row++
        } else if (field[2] == "end") {
            ended = field[3]
        } else if (field[3] ~ /^[if][48]$/ && count >= 5) {
            check_rows(file, section, row)
            section = prefix field[2]
            rows[section] = field[4]
            cols[section] = field[5]
            row = 0
            for (i = 6; i <= count; i++) {
                pair = index(field[i], "=")
                attribute[section, substr(field[i], 1, pair - 1)] = substr(field[i], pair + 1)
            }
            if (attribute[section, "enc"] != "text") die(file ": section " field[2] " is binary: run mts text")
        }
    }
    if (ended < 0) die(file ": no end line: not a whole stream")
    check_rows(file, section, row)
    close(file)
}

function check_rows(file, section, row) {
    if (section != "" && row != rows[section])
        die(file ": section " section ": " row " rows of " rows[section])
}

function need_section(section, remedy) {
    if (!(section in rows)) die("no section " section ": " remedy)
}

# Say what is wrong and stop with status 2.
function die(message) {
    print "awk: " message > "/dev/stderr"
    exit 2
}
