# Tables, landmarks and surfaces: what is read is what was written, and one line with its place for each fault.

load common.bash

setup() {
    enter_loosely
    printf '%s\n' NRRD0005 'type: short' 'encoding: ascii' 'dimension: 3' 'sizes: 2 2 2' 'space: RAS' 'space directions: (1,0,0) (0,1,0) (0,0,1)' \
        'space origin: (0,0,0)' '' '1 2 3 4 5 6 7 8' > image.nrrd
}

@test "tables: numbers to the bit, comments, blanks" {
    printf '# heading, with a comma\n\t0.10000000000000001  -1.7976931348623157e+308\t5e-324 # row\n \n.33333333333333331 69.1628 -0.0\n\n' > a.tsv
    sample --outside 0 -p a.tsv image.nrrd 2> note | tail -n 2 > read
    [ "$(cat read)" = $'0.10000000000000001 -1.7976931348623157e+308 4.9406564584124654e-324 0\n0.33333333333333331 69.162800000000004 -0 0' ]
}

@test "tables: each fault by its line" {
    each_fault a.tsv sample --outside 0 -p a.tsv image.nrrd << 'END'
2|1 2 3\n3 x 4\n|column 2: 'x' is not a finite number
1|1,5 2 3\n|'1,5' is not a finite number: write decimal points, and blanks
1|1;2 3\n|blanks between numbers
3|1 2 3\n# c\n3 nan 4\n|'nan' is not a finite number
1|1 -inf 3\n|'-inf' is not a finite number
1|1 2#3 4\n|'2#3' is not a finite number
2|1 2\n1 2 3\n|has 3 columns, the rows before 2
2|1 2 3\n1 2\n|has 2 columns, the rows before 3
1|1\n|has 1 columns, not 
1|1 2 3 4 5\n|has 5 columns, not 
1|1 2 3\r\n|carriage return
1|\xef\xbb\xbf1 2 3\n|byte order mark
2|1 2 3\n3 4 5|last line without newline: truncated?
0||is empty
0|# only a comment\n\n|holds no row of numbers
2|1 2 3\n3\0 4 5\n|control character 0x00
1|1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n|more than 64 columns
END
    refused 2 "is a folder" sample -p . image.nrrd
    refused 2 "none.tsv: No such file or directory" sample -p none.tsv image.nrrd
}

@test "landmarks are rows in RAS, mm; each fault by its line" {
    markup='{"a": [1, {"b": [true, null]}],\n"markups": [{"controlPoints": [@]%}]}'
    point='{"label": "a\\u00e4", "position": [1, -2, 3e0]}'
    at() { sample --outside 0 -u mm -p "$1" image.nrrd 2> note | awk 'NR == 2 { print $1, $2, $3 }'; }
    json=${markup/@/$point}
    printf '%b' "${json/\%/}" > lps.mrk.json
    printf '%b' "${json/\%/, \"coordinateSystem\": \"RAS\", \"coordinateUnits\": \"mm\"}" > ras.mrk.json
    printf '# CoordinateSystem = 0\n1,1,-2,3,0,0,0,1,1,1,0,"b, c",,\n' > ras.fcsv
    printf '# CoordinateSystem = LPS\r\n# columns = label,z,y,x\r\nb,3,-2,1\r\n' > lps.fcsv
    for ending in mrk.json fcsv; do
        [ "$(at ras.$ending)" = "1 -2 3" ]
        [ "$(at lps.$ending)" = "-1 2 3" ]
    done
    for ((cut = 0; cut < $(stat -c %s lps.mrk.json); cut += 5)); do
        head -c $cut lps.mrk.json > cut.mrk.json
        [ -z "$(at cut.mrk.json)" ]
        read -r line < note
        [[ $line == "sample: cut.mrk.json:"* ]]
    done
    in_markup() { while IFS='|' read -r line points more message; do more=${markup/\%/$more}; echo "$line|${more/@/${points/P/$point}}|$message"; done; }
    in_markup > cases << 'END'
2|{"position": [1, 2, 3], "positionStatus": "undefined"}||without a position
2|{"position": [1, 2, -2, 3]}||without a position
2|{"position": [1e999, -2, 3]}||a finite number is expected
2|{"position": [1, null, -2, 3]}||a finite number is expected
2|{"position": [[1, 2], 1, -2, 3]}||a finite number is expected
2|{"position": [10000000000000000000000000000000000000000000000000000000000000000000, -2, 3]}||a finite number is expected
2|{"label": null, "position": [1, -2, 3]}||a string is expected
2||, "coordinateSystem": "IJK"|neither LPS nor RAS
2||, "coordinateUnits": "cm"|is not mm
0|||holds no point
END
    printf '%s\n' "2|${json/\%/}x|more behind the value" '1|{"a": nil}|neither true, false nor null' "1|{\"a\" 1}|':' is expected" '1|{"\\x": 1}|unknown escape' >> cases
    each_fault a.mrk.json sample --outside 0 -p a.mrk.json image.nrrd < cases
    each_fault a.fcsv sample --outside 0 -p a.fcsv image.nrrd << 'END'
2|1,1,-2,3\n2,1,x,3\n|y: 'x'
2|# columns = x,y\n1,2\n|no column z
1|# CoordinateSystem = 2\n|neither RAS nor LPS
1|1,1,-2,3|without newline
END
}

# A facet of an ASCII STL.
facet() { printf 'facet normal 0 0 1\n outer loop\n  vertex -1 -1 .05\n  vertex 2 -1 .05\n  vertex -1 2e0 .05\n endloop\nendfacet\n'; }

@test "surfaces: a table of 9 columns, an ASCII and a binary STL of one triangle are the same; solids as other programs write them; each fault" {
    cloud -d 3 -k regular -n 4 --box 0,0.1,0,0.1,0,0.1 > cube.mts
    cut() { incise -s "$1" cube.mts 2> note | mts print nodes.x; }
    echo '-1 -1 .05  2 -1 .05  -1 2 .05' > a.tsv
    { echo 'solid a name'; facet; echo 'endsolid a name'; } > ascii.STL
    /usr/bin/python3 -c 'import struct; f = lambda *v: struct.pack("<%df" % len(v), *v); h = b"solid is what some binary files begin with".ljust(80, b"\0")
t = f(0, 0, 1, -1, -1, .05, 2, -1, .05, -1, 2, .05) + b"\0\0"; one = struct.pack("<I", 1)
for name, data in {"binary": h + one + t, "cut": h + one + t[:-1], "other": b"x" + h[1:] + one + t[:-1], "none": h + struct.pack("<I", 0),
                   "far": b"x" + h[1:] + one + t[:12] + f(float("inf")) + t[16:]}.items(): open(name + ".stl", "wb").write(data)'
    { facet | sed 's/.*/\U&/; s/ 0 0 1/ nan nan nan/; s/$/\r/; 1i SOLID facet\r'; printf 'ENDSOLID facet\r\nsolid\n'; facet | sed 's/\.05/.07/'; echo endsolid; } > two.stl
    cut a.tsv > whole
    [ "$(wc -l < whole)" -gt 64 ]
    cut ascii.STL | cmp - whole
    cut binary.stl > single
    paste whole single | awk '{ for (i = 1; i <= 3; i++) if (!(($i - $(i + 3)) ^ 2 < 1e-16)) exit 1 }'
    [ "$(cut two.stl | wc -l)" -gt "$(wc -l < whole)" ]
    refused 2 "truncated?" incise -s cut.stl cube.mts
    refused 2 "other.stl: neither ASCII STL" incise -s other.stl cube.mts
    refused 2 "far.stl: triangle 1: coordinate that is not finite" incise -s far.stl cube.mts
    refused 2 "none.stl: holds no triangle" incise -s none.stl cube.mts
    for ((at = 0; at < $(stat -c %s ascii.STL) - 8; at += 5)); do # only the solid's closing name may go missing
        head -c $at ascii.STL > part.stl
        status=0
        incise -s part.stl cube.mts > out 2> said || status=$?
        read -r line < said
        [[ $status -eq 2 && $line == "incise: part.stl"* ]]
    done
    { echo solid; facet; echo endsolid; facet; } > behind.stl
    refused 2 "behind.stl:10: 'facet' stands outside of 'solid'" incise -s behind.stl cube.mts
    each_fault a.stl incise -s a.stl cube.mts <<< "4|solid\nfacet normal 0 0 1\nouter loop\nvertex 1,0\n|'1,0' is not a finite number"
}
