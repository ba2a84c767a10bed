# Scenes: what spells the same is the same, and one line with its place for each thing that can be wrong.

load common.bash

setup() { enter_loosely; }

# faults < CASES: as each_fault has them, of scenes. @h: a head in 2D, @3 in 3D, @d of a dynamic scene; @r: a material's region, @b: all of it;
# @g, @z: of laws with fibres
faults() {
    local h='[scene]\ndim = 2\nanalysis = quasi-static\n' r='[material m]\nregion = r\n' line key
    local d=${h/quasi-static/dynamic} b="${r}E = 3000\nnu = .49\nrho = 1000\n" three=${h/2/3}
    local g="${r}model = guccione\nC = 9\nbf = 1\nbt = 1\nbfs = 1\nkappa = 1e5\n" z="${r}model = holzapfel-gasser-ogden\nc = 9\nk1 = 1\nk2 = 1\ngamma = 30\nkappa = 1e5\n"
    while IFS= read -r line; do
        for key in h d r b g z; do line=${line//@$key/${!key}}; done
        printf '%s\n' "${line//@3/$three}"
    done > cases
    each_fault bad.scene mtled bad.scene < cases
}

@test "the form is strict: sections, keys, numbers, bytes" {
    faults << 'END'
9|@h@b[materials m]\n|unknown section: allowed are scene, material
10|@h@b[output]\n[output]\n|already in line 9
9|@h@bE = 4000\n|[material m]: E: already in line 6
9|@h@b[scene x]\n|takes no name
9|@h@b[contact]\n|lacks its name
9|@h@b[contact a b]\n|section header
9|@h@b[contact a] junk\n|section header
9|@h@b[contact a\n|section header
9|@h@b[]\n|section header
1|dim = 2\n@h@b|before the first [section]
9|@h@bjunk\n|nor key = value
9|@h@btwo words = 3\n|not one word
9|@h@b= 3\n|not one word
9|@h@bmodel =\n|model: has no value
0|# nothing\n|no section [scene]
0|@b|no section [scene]
0|@h|no section [material NAME]
1|[scene]\ndim = 2\n@b|[scene]: analysis: missing
1|[scene]\nanalysis = quasi-static\n@b|[scene]: dim: missing
2|[scene]\ndim = 2.5\nanalysis = dynamic\n@b|dim: '2.5' is not a whole number
3|[scene]\ndim = 2\nanalysis = static\n@b|none of quasi-static, dynamic
0|@d@b|end_time: missing
6|@h@rE = 3000 Pa\nnu = .49\nrho = 1\n|'3000 Pa' is not a finite number: write it in SI units, without the name of one
6|@h@rE = 0x10\nnu = .49\nrho = 1\n|'0x10' is not a finite number
1|\xff\xfe@h@b|byte order mark
2|[scene]\nd\0m = 2\n|control character 0x00
0||is empty
9|@h@b[output]|last line without newline
END
}

@test "keys of materials" {
    faults << 'END'
4|@h@rnu = .3\nrho = 1\n|E: missing: give Young's modulus in Pa
5|@hgravity = 0, -9.81\n[material m]\nregion = r\nE = 3\nnu = .3\n|rho: missing: give the density in kg/m3
4|@d@rE = 3\nnu = .3\n|rho: missing: give the density in kg/m3
4|@h[material m]\nE = 3\nnu = .3\nrho = 1\n|region: missing
9|@h@bmodel = hooke\n|model: 'hooke' is none of neo-hookean, neo-hookean-log
4|@h@bmodel = ogden\n|alpha: missing
10|@h@bmodel = ogden\nalpha = 0\n|must not be 0
9|@h@bratio = 1\n|not allowed: it belongs to model mooney-rivlin
10|@h@bmodel = mooney-rivlin\nratio = -1\n|-1 is not at least 0
10|@h@bmodel = ogden\nalpha = 1, 2\n|alpha: E goes with one number
9|@h@bkappa = 1\n|kappa: not allowed: nu gives the volume: give one of nu, kappa, D
9|@h@bmu = 1\n|mu: not allowed: the stiffness is given by E
6|@h@rE = 9\nkappa = 1\n|E: is not below 9 kappa
4|@h@rmu = 1\nD = 1e-320\n|the moduli are too small or too large
4|@h@rmodel = yeoh\nc1 = 1e-300\nc2 = 1e300\nnu = 0\n|the moduli are too small or too large
6|@h@rmu = 1, 2\nkappa = 1\n|mu: has more than 1 number
7|@h@rmodel = ogden\nmu = 1, -1\nalpha = 2, 3\nnu = 0\n|mu: the sum is not positive
8|@h@rmodel = ogden\nmu = 1, 2\nalpha = 3\nnu = 0\n|alpha: mu and alpha have different
7|@h@rmodel = mooney-rivlin\nc1 = 1\nc2 = -1\nnu = 0\n|c1: c1 + c2 is not positive
8|@h@rmodel = mooney-rivlin\nc1 = 1\nratio = 1\n|ratio: not allowed: it goes with E
9|@h@bfibre = 1, 0\n|fibre: not allowed: the law has no fibres, and no active
9|@h@bcurve = step\n|curve: not allowed: it goes with active
9|@h@bprony = .45 .5, .55 50\n|prony: the sum of g is 1, not below 1
9|@h@bprony = .45 .5, .365 0\n|prony: 0 is not above 0
9|@h@bprony = 0 .5\n|prony: 0 is not within (0, 1)
9|@h@bprony = .45, .5\n|prony: '.45' is not a term: write g and tau in s
9|@h@bprony = .1 1, .1 2, .1 3, .1 4, .1 5, .1 6, .1 7\n|prony: has more than 6 terms
9|@h@bprony = .45 .5\n|prony: the scene has no time: give duration in [scene], s
0|@h@b[solver]\ntime_steps = 5\n|time_steps: not allowed: the scene has neither duration nor friction
11|@hduration = 1\n@b[solver]\nmethod = relaxation\n|method: a scene with duration takes newton
4|@dduration = 1\n@b|duration: not allowed: a dynamic scene
0|@hduration = 1\n@b|[scene]: duration: of no use
12|@h@gfibre = 0, -0\n|fibre: has no length: give a direction, as 1, 0, 0
12|@h@gfibre = 0, 0, 1\n|fibre: has 3 components: dim = 2 needs 2
13|@h@gfibre = 0, 1\nfibre_plane = 0, 1\n|fibre_plane: not allowed: in 2D it is
13|@3@gfibre = 0, 1, 0\nfibre_plane = 1, 0, 0\n|the law has one family of fibres
4|@3@zfibre = 0, 1, 0\n|fibre_plane: missing: give a direction that spans
13|@3@zfibre = 0, 1, 0\nfibre_plane = 0, 2, 1e-7\n|no direction other than fibre
12|@3@zdispersion = .4\nfibre = 0, 1, 0\nfibre_plane = 1, 0, 0\n|dispersion: .4 is not within [0, 0.333333]
10|@h@rmodel = trans-iso\nc1 = 1\nc3 = 1\nc4 = 1\nc5 = 2\nfibre = 0, 1\n|c5: not allowed: it goes with lambda_max
6|@h@bmodel = yeoh\n|E: not allowed: the law has its own moduli
4|@h@rmodel = yeoh\nc1 = 1\n|nu: missing: give Poisson's ratio, or kappa in Pa, or D
6|@h@btable = t\n|E: not allowed: the table gives E and nu
7|@h@rrho = 1\ntable = t\n|table: needs unit
9|@h@b[material n]\nregion = q,r\nE = 1\nnu = 0\nrho = 1\n|[material n]: region: 'r' is of material m already
5|@h[material m]\nregion = r, q, r\n|region: names 'r' twice
END
}

@test "keys of conditions, of the solver and the output" {
    faults << 'END'
9|@h@b[displacement d]\nfacets = f\n|none of table, components, normal: give exactly one
9|@h@b[displacement d]\nfacets = f\nnormal = 0\ncomponents = 0,0\n|several of table
9|@h@b[displacement d]\n\n|none of facets, nodes
11|@h@b[displacement d]\nnodes = f\nnormal = 0\n|normal: not allowed: it goes with facets
11|@h@b[displacement d]\nfacets = f\ntable = t\n|table: needs unit = m, cm, mm or um
11|@h@b[displacement d]\nfacets = f\ncomponents = 0,1,2\n|has 3 components: dim = 2 needs 2, with decimal points
11|@h@b[displacement d]\nfacets = f\ncomponents = free,free\n|all are free
11|@h@b[displacement d]\nfacets = f\ncomponents = 0,\n|'' is not a finite number
11|@h@b[force d]\nnodes = f\ncomponents = 0,free\n|'free' is not a finite number
10|@h@b[force d]\nfacets = f\ncomponents = 0,1\n|facets: unknown key
9|@h@b[force d]\nnodes = f\n|components: missing: give the force on each node in N
9|@h@b[pressure d]\nfacets = f\n|none of value, density
9|@h@b[contact c]\nfacets = f\nrigid = s\nunit = m\n|side: missing: left or right
13|@h@b[contact c]\nfacets = f\nrigid = s\nunit = m\nside = front\n|none of left, right
13|@3@b[contact c]\nfacets = f\nrigid = s\nunit = m\nside = left\n|none of front, back
10|@h@b[solver]\ntolerance = 1\n|tolerance: 1 is not within (0, 1)
10|@h@b[solver]\nend_time = 1\n|a quasi-static scene has duration, in [scene]
10|@h@b[solver]\nmax_steps = 0\n|max_steps: 0 is not within [1,
10|@h@b[solver]\nmax_steps = 1e3\n|'1e3' is not a whole number
10|@h@b[solver]\nconstraints = penalty\n|none of ebciem, direct
11|@d@b[solver]\nend_time = 1\ntolerance = .1\n|not allowed
10|@h@b[initial]\ntable = t\nunit = m\n|only dynamic scenes begin somewhere
10|@h@b[output]\ninterval = .1\n|a quasi-static scene has no time: use frames
10|@h@b[output]\nenergy = /etc/passwd\n|is none of no, yes
END
}

@test "a scene that is a folder or a device is refused; comments, blanks, names of files and order change nothing" {
    refused 2 "is a folder" mtled .
    refused 2 "is a folder, device or socket" mtled /dev/zero
    cloud -d 2 -k regular -n 5 --box 0,0.1,0,0.1 | shapefn > table.mts 2> note
    mkdir in
    printf '0 0\n1 1\n' > in/curve.tsv
    { pressed_block; printf 'curve = curve.tsv\n[output]\nframes = 1\n'; } > in/plain.scene
    { printf '# a comment\n[scene] ; trailing\n  title = %01000d    # more\n\tdim=2\nanalysis   =  quasi-static\n[output]\n frames = 1 # each\n' 7
        sed -n '/^\[displacement/,/^curve/p' in/plain.scene | sed "s|curve.tsv|$PWD/in/&|; s/0, -0.005/0,-5e-3 ; m/"
        sed -n '/^\[material/,/^rho/s/^rho = 1000/  rho = 1e3/p; /^\[material/,/^nu/p' in/plain.scene; } > other.scene
    mtled in/plain.scene table.mts > plain.dat
    mtled other.scene table.mts > other.dat
    cmp <(mts print u.frame.1 plain.dat) <(mts print u.frame.1 other.dat)
}
