# make incision: cuts with known answers, made by incise and in the mesh; cuts that contact closes; 100 random cuts, some that cross; one that advances through a liver
#
# incision.tsv has a row for each, blades/blades.tsv one for each random cut, profile.png the openings; advances.png is a row of pictures (examples/liver/cut.sh), retraction.png has fifteen frames of faces drawn apart.

INCISION := $(OUT)/incision
INCISION_SCRIPTS := pipelines/incision
INCISION_SIZES := 5 10 20
INCISION_OPENINGS := $(foreach case,slit slit_in_mesh penny penny_in_mesh,$(INCISION_SIZES:%=$(case)-%))
INCISION_PROGRAMS := $(addprefix $(BUILD)/bin/,cloud nodes tag incise shapefn mtled mts)
INCISION_LOG = 2> $(@:.dat=.log) || { cat $(@:.dat=.log) >&2; false; }
# 4 (1 - nu^2) sigma a / E and 8 (1 - nu^2) sigma a / (pi E), a = 10 mm, sigma = E / 10000
slit.exact := 0.00364
slit_in_mesh.exact := 0.00364
penny.exact := 0.0023172960
penny_in_mesh.exact := 0.0023172960

.PHONY: incision
incision: $(addprefix $(INCISION)/,incision.tsv profile.png advances.png retraction.png)
	@awk -F '\t' '{ printf "%-22s %5s %6s %-38s %11s %11s %8s %6s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8 }' $<
	$(PICTURES)

$(INCISION)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(INCISION_SIZES:%=$(INCISION)/slit-%.msh): $(INCISION)/slit-%.msh: $(INCISION_SCRIPTS)/slit.geo
	@mkdir -p $(@D)
	gmsh -2 -v 1 -setnumber h $$(echo $* | awk '{ print 10 / $$1 }') $< -o $@
$(INCISION_SIZES:%=$(INCISION)/penny-%.msh): $(INCISION)/penny-%.msh: $(INCISION_SCRIPTS)/penny.geo
	@mkdir -p $(@D)
	gmsh -3 -nt 1 -v 1 -setnumber h $$(echo $* | awk '{ print 10 / $$1 }') $< -o $@

$(INCISION)/rim.tsv: $(INCISION_SCRIPTS)/rim.awk
	@mkdir -p $(@D)
	awk -f $< > $@

$(INCISION)/slit-%.mts: $(INCISION)/slit-%.msh $(INCISION_PROGRAMS)
	printf '%s\n' '-10 0' '10 0' > $(@:.mts=.txt)
	nodes -u mm $< | incise -v -s $(@:.mts=.txt) -u mm -o $@
$(INCISION)/penny-%.mts: $(INCISION)/penny-%.msh $(INCISION_SCRIPTS)/disc.awk $(INCISION_PROGRAMS)
	awk -f $(INCISION_SCRIPTS)/disc.awk -v n=$$((8 * $*)) > $(@:.mts=.tsv)
	nodes -u mm $< | tag -f x0=low:x,0.01% -f y0=low:y,0.01% -f bottom=low:z,0.01% -f top=high:z,0.01% | incise -v -s $(@:.mts=.tsv) -u mm -o $@

# The same cuts as faces of the mesh.
INCISION_CRACK = gmsh -v 1 -setstring mesh $(abspath $(@D))/whole.msh -setstring cracked $(abspath $@)
$(INCISION_SIZES:%=$(INCISION)/slit_in_mesh-%.msh): $(INCISION)/slit_in_mesh-%.msh: $(addprefix $(INCISION_SCRIPTS)/,slit.geo crack.geo)
	@mkdir -p $(@D)
	gmsh -2 -v 1 -setnumber meshed 1 -setnumber h $$(echo $* | awk '{ print 10 / $$1 }') $< -o $(@D)/whole.msh
	$(INCISION_CRACK) $(INCISION_SCRIPTS)/crack.geo -parse_and_exit
$(INCISION_SIZES:%=$(INCISION)/penny_in_mesh-%.msh): $(INCISION)/penny_in_mesh-%.msh: $(addprefix $(INCISION_SCRIPTS)/,penny.geo crack.geo)
	@mkdir -p $(@D)
	gmsh -3 -nt 1 -v 1 -setnumber meshed 1 -setnumber h $$(echo $* | awk '{ print 10 / $$1 }') $< -o $(@D)/whole.msh
	$(INCISION_CRACK) -setnumber across 2 -setnumber open 3 $(INCISION_SCRIPTS)/crack.geo -parse_and_exit
$(INCISION_SIZES:%=$(INCISION)/slit_in_mesh-%.mts): %.mts: %.msh $(INCISION_PROGRAMS)
	nodes -u mm $< | tag -f 'front=slit and normal:0,-1,30' -f 'back=slit and normal:0,1,30' -d slit -o $@
$(INCISION_SIZES:%=$(INCISION)/penny_in_mesh-%.mts): %.mts: %.msh $(INCISION_PROGRAMS)
	nodes -u mm $< | tag -f x0=low:x,0.01% -f y0=low:y,0.01% -f bottom=low:z,0.01% -f top=high:z,0.01% \
	    -f 'front=slit and normal:0,0,-1,30' -f 'back=slit and normal:0,0,1,30' -d facets:slit -o $@

$(INCISION)/%.scene: $(INCISION_SCRIPTS)/%.scene
	@mkdir -p $(@D)
	cp $< $@

$(foreach case,slit slit_in_mesh,$(INCISION_SIZES:%=$(INCISION)/$(case)-%.dat)): $(INCISION)/slit.scene $(INCISION)/rim.tsv
$(foreach case,penny penny_in_mesh,$(INCISION_SIZES:%=$(INCISION)/$(case)-%.dat)): $(INCISION)/penny.scene
$(INCISION_OPENINGS:%=$(INCISION)/%.dat): %.dat: %.mts
	mtled -v $(@D)/$(firstword $(subst _, ,$(subst -, ,$(notdir $*)))).scene $< > $@ $(INCISION_LOG)

# The faces of the cut are the last two groups.
$(INCISION_OPENINGS:%=$(INCISION)/%.row): %.row: %.dat %.mts $(INCISION_SCRIPTS)/opening.awk
	bash -c 'paste <(mts print facets.set $*.mts) <(mts print facets $*.mts)' | awk '{ for (i = 2; i <= NF; i++) lip[$$i] = $$1; if ($$1 > last) last = $$1 } \
	    END { for (n in lip) if (lip[n] >= last - 1) print lip[n], n }' > $*.lips
	bash -c 'paste <(mts print nodes.x $*.mts) <(mts print u $*.dat)' | awk -f $(INCISION_SCRIPTS)/opening.awk -v case=$(firstword $(subst -, ,$(notdir $*))) \
	    -v size=$(lastword $(subst -, ,$(notdir $*))) -v exact=$($(firstword $(subst -, ,$(notdir $*))).exact) -v profile=$*.profile $*.lips - > $@

$(INCISION)/parts.row: $(INCISION_SCRIPTS)/parts.sh $(INCISION_PROGRAMS)
	@mkdir -p $(@D)/parts
	bash $< $(@D)/parts > $@

$(INCISION)/blades.row: $(INCISION_SCRIPTS)/blades.sh $(INCISION_SCRIPTS)/blade.awk $(INCISION_PROGRAMS) $(BUILD)/bin/voxels
	@mkdir -p $(@D)/blades
	bash $< $(@D)/blades $(<D) examples > $@

$(INCISION)/incision.tsv: $(INCISION_OPENINGS:%=$(INCISION)/%.row) $(INCISION)/parts.row $(INCISION)/blades.row pipelines/incision.mk
	(printf 'case\tnodes_a_radius\tnodes\tquantity\tvalue\treference\terror\torder\n'; cat $(filter %.row,$^) | awk -F '\t' -v OFS='\t' '{ \
	    print $$0, $$2 != "-" && $$1 == before ? sprintf("%.2f", log(error / $$7) / log(2)) : "-"; before = $$1; error = $$7 }') > $@

$(INCISION)/profile.png: $(INCISION)/incision.tsv $(INCISION_SCRIPTS)/profile.gp
	gnuplot -e "folder='$(@D)'; out='$@'" $(INCISION_SCRIPTS)/profile.gp

$(INCISION)/advances/u5.dat: $(addprefix examples/liver/,cut.sh cut.scene labels.nii.gz labels.tsv) $(INCISION_PROGRAMS) $(BUILD)/bin/voxels
	@mkdir -p $(@D)
	examples/liver/cut.sh $(@D)

# A liver of 10 000 nodes, cut from above, whose faces are drawn apart.
$(INCISION)/retract.mts: $(addprefix examples/liver/,labels.nii.gz labels.tsv) $(INCISION_PROGRAMS) $(BUILD)/bin/voxels
	@mkdir -p $(@D)
	printf '%s\n' '-45 -200 110 -45 200 110 -45 200 300' '-45 -200 110 -45 200 300 -45 -200 300' > $(@D)/retract.tsv
	voxels -h 7.4mm -l examples/liver/labels.tsv examples/liver/labels.nii.gz | \
	    tag -u mm -d 'liver|outside' -f 'held=ball:30,-50,140,60 and normal:0,-1,0,50 without liver|kidney' | \
	    incise -v -s $(@D)/retract.tsv -u mm -n knife | \
	    tag -u mm -f 'left=knife|back and half:0,0,130,0,0,1' -f 'right=knife|front and half:0,0,130,0,0,1' | shapefn -o $@
$(INCISION)/retract.dat: $(INCISION)/retract.mts examples/liver/retract.scene
	mtled -v -o $@ examples/liver/retract.scene $<

# Without ImageMagick the last picture alone.
$(INCISION)/retraction.png: $(INCISION)/retract.dat pipelines/render.py
	for i in $$(seq 15); do pipelines/render.py --view=-0.3,1,0.25 --most 12 --frame $$i --title "$$i" $< $(@D)/retract-$$i.png || exit; done
	if command -v montage > /dev/null; then montage $(patsubst %,$(@D)/retract-%.png,$(shell seq 15)) -crop 640x610+30+0 +repage -tile 5x3 -geometry 320x305+0+0 $@; \
	    else cp $(@D)/retract-15.png $@; fi
$(INCISION)/advances.png: $(INCISION)/advances/u5.dat pipelines/render.py
	for i in 1 2 3 4 5; do pipelines/render.py --view=-0.3,1,0.25 --title "advance $$i" $(<D)/u$$i.dat $(<D)/$$i.png || exit; done
	if command -v convert > /dev/null; then convert $(foreach i,1 2 3 4 5,\( $(<D)/$(i).png -crop 640x610+30+0 +repage \)) +append -resize 50% $@; else cp $(<D)/5.png $@; fi
