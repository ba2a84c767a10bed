# make estimate: how well runs know their remaining error, on the hard cases
#
# Each equilibrium of the hard cases to 1e-3 and to 1e-5: the estimated error, with the remaining penetration of contacts, which is to be an upper
# bound; the true one, against a run to 1e-8, the larger of those at the worst node and on the whole; force evaluations.
ESTIMATE := $(OUT)/estimate
ESTIMATE_CASES := 02-homogeneous 07-column 08-cylinder 10-elastica 11-cook 12-bonded 17-block 19-cube 22-contact

.PHONY: estimate
estimate: $(ESTIMATE)/estimate.tsv $(ESTIMATE)/summary.tsv
	@awk -F '\t' '{ printf "%-16s %9s %9s %9s %14s %11s  %s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7 }' $<
	@! grep -q 'FAIL$$' $<

$(ESTIMATE)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(ESTIMATE_CASES:%=$(ESTIMATE)/%.rows): $(ESTIMATE)/%.rows: pipelines/hard/%.sh pipelines/hard/common.sh $(HARD_TOOLS) $(wildcard examples/hard/*)
	@mkdir -p $(@D)
	rm -f $@.new
	ESTIMATE=$@.new bash $< > /dev/null
	mv $@.new $@

$(ESTIMATE)/estimate.tsv: $(ESTIMATE_CASES:%=$(ESTIMATE)/%.rows)
	(printf 'case\ttolerance\testimate\terror\terror/estimate\tevaluations\tverdict\n'; cat $^) > $@

# What the texts say of it, of the runs to each tolerance.
$(ESTIMATE)/summary.tsv: $(ESTIMATE)/estimate.tsv
	awk -F '\t' -v OFS='\t' 'NR > 1 { t = $$2; n[t]++; pass[t] += $$7 == "pass"; worst[t] = $$5 + 0 > worst[t] ? $$5 : worst[t] } \
	    END { print "tolerance", "runs", "pass", "largest error/estimate"; for (t in n) print t, n[t], pass[t], worst[t] }' $< | sort -r > $@
