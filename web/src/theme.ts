// Dark, light, or as the system has it; kept between visits.
import { remember, remembered } from "./remember.js";

const CHOICES = ["auto", "dark", "light"] as const;
export type Theme = (typeof CHOICES)[number];
const KEY = "gnomon-theme";

const stored = (): Theme => CHOICES.find((c) => c === remembered(KEY)) ?? "auto";

export class ThemeSwitch {
  private theme = stored();
  private readonly system = matchMedia("(prefers-color-scheme: light)");

  constructor(
    private readonly button: HTMLElement,
    private readonly changed: () => void,
  ) {
    button.addEventListener("click", () => this.next());
    this.system.addEventListener("change", () => this.apply());
    this.apply();
  }

  next(): void {
    this.theme = CHOICES[(CHOICES.indexOf(this.theme) + 1) % CHOICES.length]!;
    remember(KEY, this.theme);
    this.apply();
  }

  private apply(): void {
    const light = this.theme === "light" || (this.theme === "auto" && this.system.matches);
    document.documentElement.dataset["theme"] = light ? "light" : "dark";
    const label = this.theme === "auto" ? `Colours: as the system has them (${light ? "light" : "dark"})` : `Colours: ${this.theme}`;
    this.button.title = `${label} (t)`;
    this.button.setAttribute("aria-label", label);
    this.button.dataset["theme"] = this.theme;
    this.changed();
  }
}
