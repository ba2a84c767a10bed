# make brain3d: the whole brain: several schemes and CalculiX without the skull on 3 290 nodes, compared with the default on 15 428;
# then the default sliding on the skull, coarse and fine. make brain3d-fine adds the default on 61 700 nodes: half an hour.
#
# CalculiX solves the scene without contact: with it, its quadratic tetrahedra take more than a quarter of an hour.
#
# Everything lies in build/out/brain3d. A scheme S has S.dat (the displacements, a text stream), S.log (what the tools
# report), S.errors (its distance from the reference), S.row (its line of compare.tsv) and S.balance (that of balance.tsv).

BRAIN3D := $(OUT)/brain3d
BRAIN3D_INPUT := examples/brain3d
BRAIN3D_TABLES := $(BRAIN3D_INPUT)/load.tsv $(BRAIN3D_INPUT)/skull.tsv
BRAIN3D_AT_NODES := mls1-at-nodes mmls-at-nodes
BRAIN3D_FREE := $(BRAIN3D_AT_NODES) small-free calculix-free
BRAIN3D_SMALL := $(BRAIN3D_FREE) small
BRAIN3D_LARGE := large-free large

# What each is called in compare.tsv.
mls1-at-nodes.name := linear MLS, 4 points, k = 1.4, conditions at nodes, pointwise volume
mmls-at-nodes.name := MMLS, 4 points, k = 1.8, conditions at nodes, pointwise volume
small-free.name := MMLS, smoothed cells, nodal volume, boundary averages (default)
calculix-free.name := CalculiX C3D10, same tetrahedra
large-free.name := the default on a finer mesh (reference)
small.name := sliding on the skull: default
large.name := sliding on the skull: the default on a finer mesh (reference)

.PHONY: brain3d brain3d-fine
brain3d: $(BRAIN3D)/compare.tsv $(BRAIN3D)/balance.tsv $(BRAIN3D)/brain3d.png $(BRAIN3D)/brain3d.vtu
	@awk -F '\t' '{ printf "%-74s %6s %6s %8s %8s %6s %8s %16s %16s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8, $$9 }' $<
	@echo
	@awk -F '\t' '{ printf "%-74s %8s %7s %7s %9s %9s %9s %9s %7s %8s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8, $$9, $$10 }' \
	    $(BRAIN3D)/balance.tsv

$(BRAIN3D)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

# ---- mesh ------------------------------------------------------------------------------------------------------------

$(BRAIN3D)/small.msh: BRAIN3D_SIZE := 13.8
$(BRAIN3D)/large.msh: BRAIN3D_SIZE := 6.2
$(BRAIN3D)/fine.msh: BRAIN3D_SIZE := 3.7

$(BRAIN3D)/brain3d_surfaces.msh: $(BRAIN3D_INPUT)/brain3d_surfaces.msh.gz
	@mkdir -p $(@D)
	gzip -dc $< > $@

# The geometry merges the surfaces beside it.
$(BRAIN3D)/brain3d.geo: $(BRAIN3D_INPUT)/brain3d.geo
	@mkdir -p $(@D)
	cp $< $@

$(BRAIN3D)/small.msh $(BRAIN3D)/large.msh $(BRAIN3D)/fine.msh: $(BRAIN3D)/brain3d.geo $(BRAIN3D)/brain3d_surfaces.msh
	gmsh -3 -nt 1 -v 2 $< -setnumber lc $(BRAIN3D_SIZE) -o $@

# The cloud is renewed only when it changes, so that a rebuilt tool does not call for a new CalculiX solution.
$(BRAIN3D)/small.made: $(BRAIN3D)/small.msh $(BUILD)/bin/nodes
	nodes -u mm -t $< > $(@:.made=.new)
	cmp -s $(@:.made=.new) $(@:.made=.cloud.dat) || cp $(@:.made=.new) $(@:.made=.cloud.dat)
	rm $(@:.made=.new)
	touch $@

$(BRAIN3D)/small.cloud.dat: $(BRAIN3D)/small.made ;

# ---- solutions -------------------------------------------------------------------------------------------------------

BRAIN3D_PROGRAMS := $(addprefix $(BUILD)/bin/,nodes ipoints support shapefn mtled)

# What is said on standard error goes to S.log, and is shown when the command fails.
BRAIN3D_LOG = 2> $(@:.dat=.log) || { cat $(@:.dat=.log) >&2; false; }

$(BRAIN3D)/%-free.dat: BRAIN3D_SCENE := $(BRAIN3D_INPUT)/free.scene
BRAIN3D_SCENE := $(BRAIN3D_INPUT)/brain3d.scene

define BRAIN3D_SOLVE
(nodes -u mm $< | ipoints | support -v | shapefn | mtled -v $(BRAIN3D_SCENE)) > $@ $(BRAIN3D_LOG)
endef

$(BRAIN3D)/small.dat $(BRAIN3D)/large.dat $(BRAIN3D)/fine.dat: $(BRAIN3D)/%.dat: $(BRAIN3D)/%.msh \
        $(BRAIN3D_INPUT)/brain3d.scene $(BRAIN3D_TABLES) $(BRAIN3D_PROGRAMS)
	$(BRAIN3D_SOLVE)

$(BRAIN3D)/small-free.dat $(BRAIN3D)/large-free.dat: $(BRAIN3D)/%-free.dat: $(BRAIN3D)/%.msh \
        $(BRAIN3D_INPUT)/free.scene $(BRAIN3D_TABLES) $(BRAIN3D_PROGRAMS)
	$(BRAIN3D_SOLVE)

# The paper's schemes, with local radii as these clouds are graded: four points per tetrahedron, conditions at the nodes.
mls1-at-nodes.support := --reach distance -k 1.4 -b mls1
mmls-at-nodes.support := --reach distance -k 1.8 -b mmls2

$(BRAIN3D_AT_NODES:%=$(BRAIN3D)/%.dat): $(BRAIN3D)/%.dat: $(BRAIN3D)/small.msh $(BRAIN3D_INPUT)/paper.scene \
        $(BRAIN3D_TABLES) $(BRAIN3D_PROGRAMS)
	(nodes -u mm $< | ipoints -g 4 | support -v $($*.support) | shapefn | \
	    mtled -v $(BRAIN3D_INPUT)/paper.scene) > $@ $(BRAIN3D_LOG)

BRAIN3D_CALCULIX := $(addprefix pipelines/,calculix/solve.sh calculix/deck.awk calculix/deck3d.awk calculix/field.awk stream.awk scene.awk)

$(BRAIN3D)/calculix-free.dat: $(BRAIN3D_INPUT)/free.scene $(BRAIN3D)/small.cloud.dat $(BRAIN3D_TABLES) $(BRAIN3D_CALCULIX)
	bash pipelines/calculix/solve.sh $(wordlist 1,2,$^) 0.25 > $@ $(BRAIN3D_LOG)

# ---- comparison ------------------------------------------------------------------------------------------------------

# Each against the finer mesh, and those without the skull also against CalculiX, in the same scene.
$(BRAIN3D_FREE:%=$(BRAIN3D)/%.errors): $(BRAIN3D)/%.errors: $(BRAIN3D)/%.dat $(BRAIN3D)/large-free.dat $(BUILD)/bin/fieldcmp
	fieldcmp $(wordlist 1,2,$^) > $@

$(BRAIN3D)/small.errors: $(BRAIN3D)/small.dat $(BRAIN3D)/large.dat $(BUILD)/bin/fieldcmp
	fieldcmp $(wordlist 1,2,$^) > $@

$(BRAIN3D_FREE:%=$(BRAIN3D)/%.beside): $(BRAIN3D)/%.beside: $(BRAIN3D)/%.dat $(BRAIN3D)/calculix-free.dat $(BUILD)/bin/fieldcmp
	fieldcmp $< $(BRAIN3D)/calculix-free.dat > $@

$(BRAIN3D_FREE:%=$(BRAIN3D)/%.row): $(BRAIN3D)/%.row: $(BRAIN3D)/%.beside
$(BRAIN3D_SMALL:%=$(BRAIN3D)/%.row): $(BRAIN3D)/%.row: $(BRAIN3D)/%.errors pipelines/brain3d/row.awk
	awk -f pipelines/brain3d/row.awk -v scheme='$($*.name)' -v field=$(@:.row=.dat) $(@:.row=.log) $(@:.row=.errors) \
	    $(filter %.beside,$^) > $@

$(BRAIN3D_LARGE:%=$(BRAIN3D)/%.row): $(BRAIN3D)/%.row: $(BRAIN3D)/%.dat pipelines/brain3d/row.awk
	awk -f pipelines/brain3d/row.awk -v scheme='$($*.name)' -v field=$< $(@:.row=.log) > $@

BRAIN3D_ROWS := $(BRAIN3D_FREE) large-free small large

$(BRAIN3D)/compare.tsv: $(BRAIN3D_ROWS:%=$(BRAIN3D)/%.row) pipelines/brain3d.mk
	(printf 'scheme\tnodes\tpoints\tavg_mm\tmax_mm\tsteps\tseconds\tcalculix_avg_mm\tcalculix_max_mm\n'; \
	    cat $(filter %.row,$^)) > $@

$(BRAIN3D_ROWS:%=$(BRAIN3D)/%.balance): $(BRAIN3D)/%.balance: $(BRAIN3D)/%.dat pipelines/brain3d/balance.awk
	awk -f pipelines/stream.awk -f pipelines/brain3d/balance.awk -v scheme='$($*.name)' -v field=$< \
	    -v report=$(@:.balance=.log) > $@

$(BRAIN3D)/balance.tsv: $(BRAIN3D_ROWS:%=$(BRAIN3D)/%.balance) pipelines/brain3d.mk
	(printf 'scheme\tpairs\tleast_J\tmost_J\tpressed_N\tskull_N\tmissing_N\tdeepest_mm\ttouching\tof\n'; \
	    cat $(filter %.balance,$^)) > $@

# ---- finer -----------------------------------------------------------------------------------------------------------

brain3d-fine: $(BRAIN3D)/small.dat $(BRAIN3D)/large.dat $(BRAIN3D)/fine.dat $(BUILD)/bin/fieldcmp
	@grep -E '^(points|pairs|steps|least J|solve seconds)' $(BRAIN3D)/fine.log
	@for coarser in small large; do \
	    echo "$$coarser - fine, m:"; PATH=$(abspath $(BUILD))/bin:$$PATH fieldcmp $(BRAIN3D)/$$coarser.dat $(BRAIN3D)/fine.dat | grep -E '^(avg|max)'; \
	done

# ---- pictures --------------------------------------------------------------------------------------------------------

$(BRAIN3D)/brain3d.vtu: $(BRAIN3D)/large.dat $(BUILD)/bin/tovtk
	tovtk -o $@ $<

$(BRAIN3D)/surface.plot $(BRAIN3D)/slice.plot: $(BRAIN3D)/%.plot: pipelines/brain3d/%.awk $(BRAIN3D)/large.dat \
        pipelines/stream.awk $(BRAIN3D_TABLES)
	awk -f pipelines/stream.awk -f $< -v field=$(BRAIN3D)/large.dat -v skull=$(BRAIN3D_INPUT)/skull.tsv > $@

$(BRAIN3D)/brain3d.png: pipelines/brain3d/picture.gp $(BRAIN3D)/surface.plot $(BRAIN3D)/slice.plot
	gnuplot -e "surface='$(BRAIN3D)/surface.plot'; slice='$(BRAIN3D)/slice.plot'; out='$@'" $<
