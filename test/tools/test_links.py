"""The check of links in Markdown files, which is part of make lint."""

import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

PAGE = """# A page: of `code`, and [links](page.md)

## Twice

## Twice

<a id="by-hand"></a>

    # not a heading, but code

- a list

    # A heading in a list

```
## fenced
```
"""


def check(folder, **files):
    """The exit code of tools/check_links on Markdown files by their names, and its lines."""
    paths = []
    for name, text in files.items():
        path = folder / f"{name}.md"
        path.write_text(text)
        paths.append(path.name)
    (folder / "image.jpg").touch()
    (folder / "with space").mkdir(exist_ok=True)
    result = subprocess.run(
        [str(ROOT / "tools" / "check_links"), *sorted(paths)],
        cwd=str(folder),
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.stdout == ""
    return result.returncode, result.stderr.splitlines()


@pytest.mark.parametrize(
    "link",
    [
        "[a](page.md)",
        "[a](./page.md 'with a title')",
        "![a](image.jpg)",
        "[![a](image.jpg)](page.md)",
        "[a](<with space>)",
        "[a](with%20space/)",
        "[a](page.md#a-page-of-code-and-links)",
        "[a](page.md#twice-1)",
        "[a](page.md#by-hand)",
        "[a](#here)",
        "[a](https://www.ros.org/nowhere.md)",
        "[a](mailto:nobody@example.org)",
        "[a][b]\n\n[b]: page.md#twice",
        '<img src="image.jpg" width="320">',
        "`[a](nowhere.md)` and ``a ` [a](nowhere.md)``",
        "text\n\n    [a](nowhere.md)\n\n    [b](nowhere.md)\n",
        "```\n[a](nowhere.md)\n```",
    ],
)
def test_good_links_pass(tmp_path, link):
    assert check(tmp_path, page=PAGE, start=f"# Here\n\n{link}\n") == (0, [])


@pytest.mark.parametrize(
    "link, said",
    [
        ("[a](nowhere.md)", "leads nowhere"),
        ("![a](Image.jpg)", "leads nowhere"),
        ("[a](../outside.md)", "leads out of the checkout"),
        ("[a](/page.md)", "is absolute"),
        ("[a]()", "is empty"),
        ("[a](page.md#not-a-heading-but-code)", "leads to no heading of page.md"),
        ("[a](page.md#fenced)", "leads to no heading of page.md"),
        ("[a](page.md#twice-2)", "leads to no heading of page.md"),
        ("[a](#Here)", "leads to no heading of start.md"),
        ("[a](image.jpg#part)", "has an anchor in what is no Markdown"),
        ("[a][b]\n\n[b]: nowhere.md", "leads nowhere"),
        ('<a href="nowhere.md">a</a>', "leads nowhere"),
        ("- a list\n\n    [a](nowhere.md)", "leads nowhere"),
        ("[of two\nlines](nowhere.md)", "leads nowhere"),
    ],
)
def test_broken_links_are_named(tmp_path, link, said):
    code, lines = check(tmp_path, page=PAGE, start=f"# Here\n\n{link}\n")
    assert code == 1
    assert len(lines) == 1 and said in lines[0]
    number = 2 + len(link.splitlines())
    assert lines[0].startswith(f"start.md:{number}: the link '")


def test_all_files_are_checked(tmp_path):
    code, lines = check(tmp_path, a="[a](b.md) [a](c.md)", b="[a](a.md#a)")
    assert code == 1
    assert [line.partition(": ")[0] for line in lines] == ["a.md:1", "b.md:1"]
