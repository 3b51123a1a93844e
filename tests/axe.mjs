// The page of a report under axe-core: no finding that is serious or worse, at the width of a desk and of a phone, light
// and dark; unfolded, which takes longest, once at each width.
// Usage: node tests/axe.mjs BROWSER PAGE, where axe-core and puppeteer-core are installed in the working directory.
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const [browserPath, page] = process.argv.slice(2);
const require = createRequire(`${process.cwd()}/`);
const { default: puppeteer } = await import(pathToFileURL(require.resolve("puppeteer-core")));
const browser = await puppeteer.launch({
  executablePath: browserPath,
  args: ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"],
  protocolTimeout: 600_000,
});
let found = 0;
for (const width of [1280, 390]) {
  for (const scheme of ["light", "dark"]) {
    const tab = await browser.newPage();
    await tab.setViewport({ width, height: 1000 });
    await tab.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
    await tab.goto(pathToFileURL(page).href);
    // A picture has one name; what it is made of would keep the check for minutes.
    await tab.evaluate(() => document.querySelectorAll("svg").forEach((picture) => picture.replaceChildren()));
    await tab.addScriptTag({ path: require.resolve("axe-core/axe.min.js") });
    for (const unfolded of (width === 390) === (scheme === "light") ? [false, true] : [false]) {
      const { violations, passes } = await tab.evaluate(async (open) => {
        if (open) document.querySelectorAll("details").forEach((part) => (part.open = true));
        const only = { resultTypes: ["violations"], elementRef: false };
        const { violations, passes } = await axe.run(document, only);
        const short = ({ id, impact, help, nodes }) =>
          ({ id, impact, help, count: nodes.length, first: nodes[0].html.slice(0, 200), why: nodes[0].failureSummary });
        return { violations: violations.map(short), passes: passes.length };
      }, unfolded);
      const grave = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
      const shape = `${width} px, ${scheme}, ${unfolded ? "unfolded" : "folded"}`;
      const slight = violations.map(({ id, impact, count }) => `${id} (${impact}, ${count})`).join(", ");
      console.log(`axe at ${shape}: ${passes} rules passed; ${slight || "no finding"}`);
      for (const { id, help, count, first, why } of grave) {
        console.error(`${shape}: ${id}: ${help}, ${count} times; the first: ${first}\n${why}`);
      }
      // A page on which no rule applies was not looked at.
      found += grave.length + (passes === 0 ? 1 : 0);
    }
    await tab.close();
  }
}
await browser.close();
process.exit(found === 0 ? 0 : 1);
