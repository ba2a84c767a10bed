# make brain2d: the brain section by several schemes and by mixed elements (FreeFEM), each compared with the converged reference.
#
# Everything lies in build/out/brain2d. A scheme S has S.dat (the displacements, a text stream), S.log (what the tools
# report), S.difference.dat (distance from the reference at the nodes) and S.row (its line of compare.tsv). The default
# scheme's displacements are also there as u.dat, and for ParaView as u.vtu.

BRAIN2D := $(OUT)/brain2d
BRAIN2D_INPUT := examples/brain2d
BRAIN2D_TABLES := $(BRAIN2D_INPUT)/load.tsv $(BRAIN2D_INPUT)/skull.tsv
BRAIN2D_AT_NODES := paper-mls1 paper-mmls quartic-mls1 quartic-mmls
BRAIN2D_SCHEMES := $(BRAIN2D_AT_NODES) default mixed mixed-half
BRAIN2D_SHOWN := paper-mls1 paper-mmls default mixed

# What each is called in compare.tsv and above its picture.
paper-mls1.name := linear MLS, 4 points, R = 8 mm, regularised weight, conditions at nodes (as in the paper)
paper-mmls.name := MMLS mu = 1e-7, 4 points, R = 8 mm, regularised weight, conditions at nodes (as in the paper)
quartic-mls1.name := linear MLS, 4 points, R = 8 mm, quartic weight, conditions at nodes
quartic-mmls.name := MMLS mu = 1e-7, 4 points, R = 10 mm, quartic weight, conditions at nodes
default.name := MMLS, smoothed cells, nodal volume, boundary averages (default)
mixed.name := mixed elements (FreeFEM), same triangles
mixed-half.name := mixed elements (FreeFEM), half the size
paper-mls1.title := linear MLS as in the paper
paper-mmls.title := MMLS as in the paper
default.title := default

.PHONY: brain2d
brain2d: $(BRAIN2D)/compare.tsv $(BRAIN2D)/section.png $(BRAIN2D)/difference.png $(BRAIN2D)/u.dat $(BRAIN2D)/u.vtu
	@awk -F '\t' '{ printf "%-98s %6s %6s %8s %8s %6s %8s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7 }' $<
	$(PICTURES)

$(BRAIN2D)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

# ---- mesh ------------------------------------------------------------------------------------------------------------

BRAIN2D_SIZES := -setnumber kb 0.72 -setnumber kv 0.58 -setnumber kt 1
$(BRAIN2D)/body.msh: BRAIN2D_SIZE := 7.3
$(BRAIN2D)/half.msh: BRAIN2D_SIZE := 3.65

$(BRAIN2D)/body.msh $(BRAIN2D)/half.msh: $(BRAIN2D_INPUT)/brain2d.geo
	@mkdir -p $(@D)
	gmsh -2 -v 2 $< -setnumber lc $(BRAIN2D_SIZE) $(BRAIN2D_SIZES) -o $@

# The cloud is renewed only when it changes, so that a rebuilt tool does not call for new solutions by mixed elements.
$(BRAIN2D)/body.made $(BRAIN2D)/half.made: $(BRAIN2D)/%.made: $(BRAIN2D)/%.msh $(BUILD)/bin/nodes
	nodes -u mm -t $< > $(@:.made=.new)
	cmp -s $(@:.made=.new) $(@:.made=.cloud.dat) || cp $(@:.made=.new) $(@:.made=.cloud.dat)
	rm $(@:.made=.new)
	touch $@

$(BRAIN2D)/body.cloud.dat $(BRAIN2D)/half.cloud.dat: $(BRAIN2D)/%.cloud.dat: $(BRAIN2D)/%.made ;

# ---- solutions -------------------------------------------------------------------------------------------------------

BRAIN2D_PIPELINE := $(BRAIN2D)/body.msh $(BRAIN2D_TABLES) \
    $(addprefix $(BUILD)/bin/,nodes ipoints support shapefn mtled)

# What is said on standard error goes to S.log, and is shown when the command fails.
BRAIN2D_LOG = 2> $(@:.dat=.log) || { cat $(@:.dat=.log) >&2; false; }

$(BRAIN2D)/default.dat: $(BRAIN2D_INPUT)/brain2d.scene $(BRAIN2D_PIPELINE)
	(nodes -u mm $(@D)/body.msh | ipoints | support -v | shapefn | mtled -v $<) > $@ $(BRAIN2D_LOG)

$(BRAIN2D)/u.dat: $(BRAIN2D)/default.dat
	cp $< $@

$(BRAIN2D)/u.vtu: $(BRAIN2D)/u.dat $(BUILD)/bin/tovtk
	tovtk -o $@ $<

# The others: four points per triangle, conditions at the nodes, and these supports, by distance as in the paper.
paper-mls1.support := --reach distance -R 8mm -b mls1 -w regularised
paper-mmls.support := --reach distance -R 8mm -b mmls2 --mu 1e-7 --mu-unit mm -w regularised
quartic-mls1.support := --reach distance -R 8mm -b mls1 -w quartic
quartic-mmls.support := --reach distance -R 10mm -b mmls2 --mu 1e-7 --mu-unit mm -w quartic

$(BRAIN2D_AT_NODES:%=$(BRAIN2D)/%.dat): $(BRAIN2D)/%.dat: $(BRAIN2D_INPUT)/paper.scene $(BRAIN2D_PIPELINE)
	(nodes -u mm $(@D)/body.msh | ipoints -g 4 | support -v $($*.support) | shapefn | \
	    mtled -v $<) > $@ $(BRAIN2D_LOG)

$(BRAIN2D)/mixed.dat: $(BRAIN2D)/body.cloud.dat
$(BRAIN2D)/mixed-half.dat: $(BRAIN2D)/half.cloud.dat
$(BRAIN2D)/mixed.dat $(BRAIN2D)/mixed-half.dat: $(BRAIN2D_INPUT)/brain2d.scene $(BRAIN2D_TABLES) $(wildcard pipelines/mixed/*) \
        $(addprefix pipelines/,stream.awk scene.awk table.awk)
	bash pipelines/mixed/solve.sh $< $(filter %.cloud.dat,$^) > $@ $(BRAIN2D_LOG)

# ---- comparison ------------------------------------------------------------------------------------------------------

$(BRAIN2D)/reference.dat: $(BRAIN2D_INPUT)/brain2d_graded.tsv pipelines/reference.awk
	@mkdir -p $(@D)
	awk -f pipelines/reference.awk $< > $@

$(BRAIN2D_SCHEMES:%=$(BRAIN2D)/%.errors): %.errors: %.dat $(BRAIN2D)/reference.dat $(BUILD)/bin/fieldcmp
	fieldcmp -t -m $(@:.errors=.difference.dat) $< $(@D)/reference.dat > $@

$(BRAIN2D_SCHEMES:%=$(BRAIN2D)/%.row): $(BRAIN2D)/%.row: $(BRAIN2D)/%.dat $(BRAIN2D)/%.errors pipelines/row.awk
	awk -f pipelines/row.awk -v scheme='$($*.name)' -v field=$< -v digits=2 $(@:.row=.log) $(@:.row=.errors) > $@

$(BRAIN2D)/compare.tsv: $(BRAIN2D_SCHEMES:%=$(BRAIN2D)/%.row) pipelines/brain2d.mk
	(printf 'scheme\tnodes\tpoints\tavg_mm\tmax_mm\tsteps\tseconds\n'; cat $(filter %.row,$^)) > $@

# ---- pictures --------------------------------------------------------------------------------------------------------

BRAIN2D_PLOT := awk -f pipelines/stream.awk -v mesh=$(BRAIN2D)/body.cloud.dat

$(BRAIN2D)/section.png: $(BRAIN2D)/default.dat $(BRAIN2D)/body.cloud.dat pipelines/stream.awk pipelines/plot/section.awk \
        pipelines/plot/section.gp
	$(BRAIN2D_PLOT) -f pipelines/plot/section.awk -v field=$< > $(@:.png=.plot)
	gnuplot -e "data='$(@:.png=.plot)'; skull='$(BRAIN2D_INPUT)/skull.tsv'; load='$(BRAIN2D_INPUT)/load.tsv'; \
	    title='Brain section, the cortex in the craniotomy moved by up to 8 mm'; out='$@'" pipelines/plot/section.gp

$(BRAIN2D_SHOWN:%=$(BRAIN2D)/%.plot): %.plot: %.errors $(BRAIN2D)/body.cloud.dat pipelines/stream.awk \
        pipelines/plot/difference.awk
	$(BRAIN2D_PLOT) -f pipelines/plot/difference.awk -v field=$(@:.plot=.difference.dat) > $@

# Title of a panel: the scheme and its errors.
BRAIN2D_TITLES = $(foreach scheme,$(BRAIN2D_SHOWN),$($(scheme).title)\n$$(awk -F '\t' '\
    { printf "mean %.3f, max %.3f mm", $$4, $$5 }' $(BRAIN2D)/$(scheme).row)|)

$(BRAIN2D)/difference.png: $(BRAIN2D_SHOWN:%=$(BRAIN2D)/%.plot) $(BRAIN2D_SHOWN:%=$(BRAIN2D)/%.row) \
        pipelines/plot/difference.gp
	gnuplot -e "data='$(filter %.plot,$^)'; titles=\"$(BRAIN2D_TITLES)\"; most=0.6; out='$@'" pipelines/plot/difference.gp
