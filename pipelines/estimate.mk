# make estimate: how well runs know their remaining error, and how many steps beyond the optimum they take, on the hard cases
#
# Each relaxation of the hard cases to 1e-3 and to 1e-5: the estimated error, with the remaining penetration of contacts, which is to be an upper bound; the true
# one, against a run to 1e-8, the larger of those at the worst node and on the whole; the steps, those in which the load went on among them, and over
# their optimum, those of the load and of the critical damping of the lowest mode, log(1 / error) w_max / w_min / 2.
ESTIMATE := $(OUT)/estimate
ESTIMATE_CASES := 02-homogeneous 07-column 08-cylinder 10-elastica 11-cook 12-bonded 17-block 19-cube 22-contact

.PHONY: estimate
estimate: $(ESTIMATE)/estimate.tsv $(ESTIMATE)/summary.tsv
	@awk -F '\t' '{ printf "%-16s %9s %9s %9s %14s %7s %5s %14s  %s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8, $$9 }' $<
	@! grep -q 'FAIL$$' $<

$(ESTIMATE)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(ESTIMATE_CASES:%=$(ESTIMATE)/%.rows): $(ESTIMATE)/%.rows: pipelines/hard/%.sh pipelines/hard/common.sh $(HARD_TOOLS) $(wildcard examples/hard/*)
	@mkdir -p $(@D)
	rm -f $@.new
	ESTIMATE=$@.new bash $< > /dev/null
	mv $@.new $@

$(ESTIMATE)/estimate.tsv: $(ESTIMATE_CASES:%=$(ESTIMATE)/%.rows)
	(printf 'case\ttolerance\testimate\terror\terror/estimate\tsteps\tramp\tsteps/optimum\tverdict\n'; cat $^) > $@

# What the texts say of it, of the runs to each tolerance.
$(ESTIMATE)/summary.tsv: $(ESTIMATE)/estimate.tsv
	awk -F '\t' -v OFS='\t' 'NR > 1 { t = $$2; n[t]++; pass[t] += $$9 == "pass" } \
	    NR > 1 && $$5 + 0 > worst[t] { worst[t] = $$5 } NR > 1 && $$8 + 0 > most[t] { most[t] = $$8 } NR > 1 && $$8 != "-" { sum[t] += $$8; m[t]++ } \
	    END { print "tolerance", "runs", "pass", "largest error/estimate", "mean steps/optimum", "largest steps/optimum"; \
	        for (t in n) if (m[t]) printf "%s\t%d\t%d\t%s\t%.2f\t%s\n", t, n[t], pass[t], worst[t], sum[t] / m[t], most[t] }' $< | sort -r > $@
