# Not a study: static checks by clang-tidy, cppcheck and shellcheck, those that are installed; make deps-lint installs them.

.PHONY: lint deps-lint
lint:
	@bash pipelines/lint.sh

deps-lint:
	@bash pipelines/deps.sh lint
