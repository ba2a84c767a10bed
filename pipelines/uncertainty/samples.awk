# A table of cases for sweep.sh: awk -f pipelines/neurosurgery/random.awk -f samples.awk -v samples=N -v seed=S > FILE
#
# Young's moduli are lognormal, their medians those of examples/brain2d and the standard deviation of their logarithms 0.3; Poisson's
# ratios are uniform between 0.45 and 0.4999. All four are independent. The numbers are the same with every awk.

BEGIN {
    random_state = seed
    for (i = 0; i < 20; i++) uniform() # small seeds begin alike
    print "case\tE_parenchyma\tE_tumour\tnu_parenchyma\tnu_tumour"
    for (i = 1; i <= samples; i++)
        printf "s%04d\t%.1f\t%.1f\t%.5f\t%.5f\n", i, 3000 * exp(0.3 * normal()), 6000 * exp(0.3 * normal()), \
            0.45 + 0.0499 * uniform(), 0.45 + 0.0499 * uniform()
}
