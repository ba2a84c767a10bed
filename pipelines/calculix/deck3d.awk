# Conditions of a deck in 3D, see deck.awk.

function deck_dim() { return 3 }

function print_contact(k) {
    die(scene ": contact only in 2D")
}
