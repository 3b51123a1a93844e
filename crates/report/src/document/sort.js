for (const table of document.querySelectorAll("table")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.textContent = head.textContent;
    button.title = "sort by this column";
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      const value = (row) => {
        const text = row.cells[column].textContent.trim();
        const part = text.match(/^≥? ?1\/(\d+)$/);
        return [part ? 1 / part[1] : parseFloat(text.replace("≥", "")), text];
      };
      const order = (a, b) => {
        const [x, y] = [value(a), value(b)];
        if (isNaN(x[0]) || isNaN(y[0])) return x[1].localeCompare(y[1]);
        return x[0] - y[0];
      };
      const body = table.tBodies[0];
      const rows = [...body.rows].sort((a, b) => (up ? order(a, b) : order(b, a)));
      body.append(...rows);
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
    });
  });
}
