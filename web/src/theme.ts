// Dark, light, or as the system has it; kept between visits.

const CHOICES = ["auto", "dark", "light"] as const;
export type Theme = (typeof CHOICES)[number];
const KEY = "gnomon-theme";

const stored = (): Theme => {
  try {
    return CHOICES.find((c) => c === localStorage.getItem(KEY)) ?? "auto";
  } catch {
    return "auto"; // pages without storage
  }
};

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
    try {
      localStorage.setItem(KEY, this.theme);
    } catch {
      // Then it lasts as long as the page.
    }
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
