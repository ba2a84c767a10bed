# Random numbers that are the same with every awk: the generator of Park and Miller 1988 (Commun. ACM 31:1192).

BEGIN { random_state = 20260 }

# Uniform in (0, 1).
function uniform() {
    random_state = (16807 * random_state) % 2147483647
    return random_state / 2147483647
}

# Of mean 0 and standard deviation 1 (Box and Muller).
function normal() { return sqrt(-2 * log(uniform())) * cos(6.283185307179586 * uniform()) }
