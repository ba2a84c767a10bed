# A scene whose weight is to be found, from a prediction that knows no load: awk -f load.awk SCENE > TEMPLATE
#
# Gravity becomes three parameters; what was measured, and is compared with, is no longer prescribed. With -v found=IDENTIFIED, what identify.sh
# has written, the prediction itself with the gravity that was found.

BEGIN {
    FS = "\t"
    gravity = "@gx@, @gy@, @gz@"
    if (found) {
        gravity = ""
        while ((getline < found) > 0) if ($1 ~ /^g[xyz]$/) gravity = gravity (gravity ? ", " : "") $2
    }
}

/^\[/ { measured = /^\[displacement (exposed|seen)\]/ }
measured && !found { next }
{ print }
/^analysis/ { print "gravity = " gravity }
