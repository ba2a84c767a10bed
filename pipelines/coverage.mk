# Not a study: which share of the lines of lib/ and tools/ the tests run, by gcov, into build/out/coverage/coverage.tsv.
# Fails below 93 %.

.PHONY: coverage
coverage:
	@find build-coverage -name '*.gcda' -delete 2> /dev/null || true
	@$(MAKE) --no-print-directory COVERAGE=1 CC=gcc check || echo "(tests are not judged here: limits on file sizes meet gcov's files, too)"
	@mkdir -p $(OUT)/coverage
	@bash pipelines/coverage.sh build-coverage > $(OUT)/coverage/new.tsv
	@mv $(OUT)/coverage/new.tsv $(OUT)/coverage/coverage.tsv
	@cat $(OUT)/coverage/coverage.tsv
	@awk -F '\t' '$$1 == "all" { exit !($$4 >= 93) }' $(OUT)/coverage/coverage.tsv
