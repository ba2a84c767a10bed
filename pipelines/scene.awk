# Reading a scene (mtled-scene(5)), for the programs of pipelines/, after pipelines/stream.awk:
# awk -f pipelines/stream.awk -f pipelines/scene.awk -f PROGRAM ...

# Sections k = 1..section_count: kind[k], label[k], scene_value[k, KEY]; [scene] itself under scene_value["scene", KEY].
function read_scene(file,    line, equals, where, words) {
    folder = file
    if (!sub(/\/[^\/]*$/, "/", folder)) folder = ""
    while ((getline line < file) > 0) {
        sub(/(^|[ \t])[#;].*/, "", line)
        if (line ~ /^\[/) {
            gsub(/[][]/, "", line)
            split(line, words)
            if (words[1] == "scene") { where = "scene"; continue }
            where = ++section_count
            kind[where] = words[1]
            label[where] = words[2]
        } else if ((equals = index(line, "=")) > 0) {
            scene_value[where, trim(substr(line, 1, equals - 1))] = trim(substr(line, equals + 1))
        }
    }
    close(file)
    if (section_count == 0) die(file ": no scene")
}

function trim(text) {
    gsub(/^[ \t]+|[ \t]+$/, "", text)
    return text
}

function metres(unit) {
    if (unit == "m") return 1
    if (unit == "cm") return 1e-2
    if (unit == "mm") return 1e-3
    if (unit == "um") return 1e-6
    die("unknown unit " unit)
}

# The number, from 0, of NAME among the names= of a section.
function name_index(section, name,    names, count, i) {
    count = split(attribute[section, "names"], names, ",")
    for (i = 1; i <= count; i++) if (names[i] == name) return i - 1
    die("no group " name " in section " section)
}
